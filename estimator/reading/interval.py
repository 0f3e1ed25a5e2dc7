"""The numbers that a field may hold, and messages about others."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.message import say
from estimator.reading.problems import shown

SMALLEST = 1e-60
"""Size of a number other than 0: no instrument resolves it, and its fourth power still differs from 0."""


@dataclass(frozen=True)
class Interval:
    """The numbers that a field may hold: 0, where it lies between the ends, or anything between them of some size."""

    low: float
    high: float
    unit: str = ""
    smallest: float = SMALLEST
    """Size of a number other than 0."""

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high and (value == 0 or abs(value) >= self.smallest)

    def held_by(self, values: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(R,) whether each value lies in the interval; False for NaN."""
        with np.errstate(invalid="ignore"):
            inside: NDArray[np.bool_] = (values >= self.low) & (values <= self.high)
            return inside & ((values == 0) | (np.abs(values) >= self.smallest))

    def fault(self, value: float) -> str:
        """Describes the fault of a number outside, with a remedy."""
        if isinstance(value, float) and math.isnan(value):
            return "is nan, which is no number; write the number, or leave it out"
        if self.low <= value <= self.high:
            parts = {"value": shown(value), "smallest": f"{self.smallest:g}"}
            return say("is {value}; must be 0 or at least {smallest} in size; write 0 for none", **parts)
        if value <= 0 < self.low:
            return say("is {value}; must be above 0, {interval}", value=shown(value), interval=self)
        return say("is {value}; must be {interval}; check the number and its unit", value=shown(value), interval=self)

    def __str__(self) -> str:
        if not self.unit:
            return say("from {low} to {high}", low=f"{self.low:g}", high=f"{self.high:g}")
        return say("from {low} to {high} {measure}", low=f"{self.low:g}", high=f"{self.high:g}", measure=self.unit)
