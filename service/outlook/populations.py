"""Drift of the units of a type, and those far out."""

from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True)
class Placed:
    """A rate among those of its type."""

    serial: str
    sensor: str
    value: float
    """Tolerances a year."""
    sigma: float
    z: float
    """Distance from the type's centre, in the spread that is expected of it."""
    tolerance: float
    """SI or relative; of the axis rad."""


@dataclass(frozen=True)
class Population:
    """Drift of the units of a type in one parameter."""

    unit_type: str
    kind: str
    parameter: str
    centre: float
    """Tolerances a year."""
    spread: float
    rates: int
    """Number of rates: one a sensor of every unit."""
    lots: int
    """Production lots of several units that were set against it."""
    fast: tuple[Placed, ...]
    """Furthest of the rates that matter, the furthest first."""
    evident: tuple[Placed, ...]
    """Furthest of the rates that chance does not explain."""
    far_lots: tuple[tuple[str, float], ...]
    """The furthest lots and their distances."""

    def z(self, value: float, sigma: float) -> float:
        """Distance of a rate from the centre, in the spread that is expected of it."""
        return (value - self.centre) / sqrt(self.spread**2 + sigma**2 + TINY)


TINY = 1e-300
"""Keeps a rate without spread from being divided by nothing."""
