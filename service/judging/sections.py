"""Sensitivity of a recording in service: the sizes from which a change of one sensor is detected."""

from dataclasses import dataclass

from estimator.parity import ParityResult
from estimator.parity.results import Sight
from service.judging.parity_words import parts_in_words
from service.kit.measures import in_words

PARAMETERS = ("bias", "scale", "axis")
"""Parameters in the order of the table."""


@dataclass(frozen=True)
class SightRow:
    """Sizes from which a change of one sensor would have been detected."""

    name: str
    share: str
    limits: tuple[tuple[str, str], ...]
    """A parameter and the size."""


@dataclass(frozen=True)
class ParityView:
    """Results of parity for a block."""

    level: str
    parameters: tuple[str, ...]
    rows: tuple[SightRow, ...]
    parts: tuple[str, ...]
    """Results of parity for the parts before and after a sensor fails."""


def parity_view(result: ParityResult) -> ParityView:
    """The table of a recording."""
    rows = tuple(
        SightRow(
            name=sensor.name,
            share=f"{100 * sensor.visible_share:.0f} %",
            limits=tuple((name, _limit(result.kind, name, getattr(sensor, name))) for name in PARAMETERS),
        )
        for sensor in result.sensors
    )
    return ParityView(f"{100 * result.false_alarm:g} %", PARAMETERS, rows, parts_in_words(result))


def _limit(kind: str, parameter: str, sight: Sight) -> str:
    return "not observed" if sight.detectable is None else in_words(kind, parameter, sight.detectable)
