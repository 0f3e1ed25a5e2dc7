"""The cause that was hidden, the reasons why one cannot be, and the amplitude that reaches a strength."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from estimator.causes.contract import Cause

FINEST = 1e-9
"""Share of the largest amplitude from which on one is sought: nothing is seen of less."""


class UnhideableError(ValueError):
    """This session cannot hold the cause, or not as strongly; the text says why."""


class TooWeakError(UnhideableError):
    """This session cannot hold the cause as weakly.

    least : standard errors that it can.
    """

    def __init__(self, text: str, least: float) -> None:
        super().__init__(text)
        self.least = least


@dataclass(frozen=True)
class HiddenCause:
    """A cause hidden in a session."""

    cause: str
    sensors: tuple[int, ...] = ()
    """Counted from 0; empty for what is common to all."""
    rows: tuple[int, ...] = ()
    """Counted from 0; empty but for rows exchanged."""
    amplitude: tuple[float, ...] = ()
    """SI, as `units` of the cause; empty for an error of the record."""
    nonlinear: tuple[float, ...] = ()
    """Nonlinear parameters, as `nonlinear_units` of the cause."""
    strength: float | None = None
    """Standard errors; None for an error of the record, which is there or not."""


def amplitude_reaching(reached: Callable[[float], float], strength: float, most: float, cause: Cause) -> float:
    """The amplitude up to ``most`` at which a growing function reaches a strength, sought on a logarithmic scale."""
    if most <= 0 or reached(most) < strength:
        raise UnhideableError(
            f"{cause.identifier} would not reach {strength:g} standard errors with {most:.3g} {cause.units[0]}"
        )
    least = np.log(FINEST * most)
    return float(np.exp(brentq(lambda x: reached(np.exp(x)) - strength, least, np.log(most), xtol=1e-6)))
