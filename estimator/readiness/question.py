"""The question of readiness: the duration of the measurement, and the drift that a sensor may have meanwhile."""

from collections.abc import Mapping
from dataclasses import dataclass

SHARE = 0.25
"""Share of a tolerance that drift may take. A steady drift by Δ over a session is spread evenly over Δ, so its expanded
uncertainty is 2Δ/√12 = 0.58 Δ; beside a third of the tolerance, which a good plan leaves to U, a quarter of it enlarges
U by a tenth: √(1/9 + (0.58/4)²) = 1.09/3.
"""

USUAL = 96 * 60.0
"""s a session takes unless it is said otherwise: 24 positions in both runs, two minutes each."""


@dataclass(frozen=True)
class Allowed:
    """Tolerances of one kind of sensor; None where a parameter is not judged."""

    bias: float | None
    """m/s² or rad/s."""
    scale: float | None = None
    """Relative."""
    quadratic: float | None = None
    """1/(m/s²)."""


@dataclass(frozen=True)
class Question:
    """The question put to a record."""

    tolerances: Mapping[str, Allowed]
    """Tolerances by kind of sensor."""
    duration: float = USUAL
    """s that the planned programme takes."""
    share: float = SHARE
    """Share of the tolerances that drift may take."""
    coefficient: Mapping[str, float] | None = None
    """One sigma of the zero's temperature coefficient by kind, m/s² or rad/s per K; None where nothing is known."""
