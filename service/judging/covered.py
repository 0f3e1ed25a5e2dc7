"""The temperatures that the calibration of a unit covers: those of its reference, and those at which it was within
tolerance of it since."""

from collections.abc import Iterable
from dataclasses import dataclass

from estimator.health.temperature_law import TemperatureStep
from estimator.results import Residuals
from service.kit.answer import answer
from service.sessions.decision import Verdict

WITHIN = (Verdict.PASS, Verdict.CONDITIONAL_PASS)
"""Verdicts by which temperature did not do much."""


@answer
@dataclass(frozen=True)
class CoveredTemperatures:
    """The temperatures that a calibration covers, °C."""

    lowest: float
    """Lowest temperature of the reference, of the sessions since that are within tolerance, and of the sessions that
    the temperature law was learned from.
    """
    highest: float
    """Highest temperature of the same sessions."""
    reference: float
    """Mean of the reference, whose parameters the others are compared with."""


def covered(
    reference: Residuals, measured: Iterable[tuple[float | None, Verdict]], steps: Iterable[TemperatureStep] = ()
) -> CoveredTemperatures | None:
    """The temperatures covered by a reference, by sessions since with their verdicts, and by the temperature law of the
    last of them; None where the reference's temperature is not known.
    """
    if reference.temperature is None:
        return None
    of_reference = [float(celsius) for celsius in reference.temperature]
    within = [celsius for celsius, verdict in measured if celsius is not None and verdict in WITHIN]
    laws = [end for step in steps for end in (step.lowest, step.highest) if end is not None]
    every = (*of_reference, *within, *laws)
    return CoveredTemperatures(min(every), max(every), sum(of_reference) / len(of_reference))
