"""Accuracy on a two-axis stand in closed form: the paper's (28)–(31) as printed, beside the checked propagation.

Both are for the estimator of half sums and half differences, (22)–(24), sensor by sensor, c = 0 and not estimated,
errors to first order, 2N readings with a reading noise of variance D_u at the input and δβ drawn anew at every one.
The printed functions are kept to compare with; nothing in the package uses them. Where they are wrong: docs/errata.md.

Checked propagation. A reading's error w_j = D_u + D_p0 (noise and variation of the zero are both new at every
reading) gives s = K·e the variances w/(N g²)·(1/cos²α, 1/(2 sin²α), 1/cos²α), of which the part along e is the
scale's. A raise ε of the head moves s by ε·(−tan α e1, cot α e2, −tan α e3). δβ_j changes a reading by
g cos α·(∓e1 cos β_j − e3 sin β_j)·δβ_j; summed over both runs

    scale  D_β/(4N)·(1 − e2²)·[1 − e2² + e2² cot²α]
    axis   D_β/(4N)·(1 − e2²)·[3 + e2² + (1 − e2²) cot²α]
    bias   D_β/(4N)·(1 − e2²)·g² cos²α

θ_y turns the axes of the two runs opposite ways, and the half sums and differences lose it.
Source: analytic alignment paper, (28)–(31).
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.planning.elevation import gyro_errors
from estimator.session import Array, StandErrors


@dataclass(frozen=True)
class Conditions:
    """Conditions of an accuracy, one sigmas. Angles in rad, the rest at the input in m/s² (rad/s)."""

    alpha: float
    """Elevation, α or χ."""
    positions: int
    """N of each run."""
    magnitude: float
    """Length of the applied vector, g or the Earth's rate."""
    noise: float
    """Noise of one reading."""
    bias_variation: float
    """Variation of the zero from reading to reading."""
    stand: StandErrors

    @property
    def raise_variance(self) -> float:
        """D_θx + D_δα."""
        return self.stand.theta_x**2 + self.stand.alpha**2


@dataclass(frozen=True, eq=False)
class Accuracy:
    """Variances, one a sensor."""

    scale: Array
    """(...,) relative."""
    bias: Array
    """(...,) (m/s²)² or (rad/s)²."""
    axis: Array
    """(...,) variance of both turns together, rad²."""


def gyro_conditions(c: Conditions, latitude: float) -> Conditions:
    """The conditions with the stand's errors as they act on gyros, (31); latitude in rad."""
    return replace(c, stand=gyro_errors(c.stand, latitude))


def printed(axes: Array, c: Conditions) -> Accuracy:
    """(28)–(30) to the letter, (29) over K²; axes (m, 3), leading axes free, unit vectors, platform axes."""
    r1, r2, r3 = (axes[..., k] ** 2 for k in range(3))
    tan, cos, sin = np.tan(c.alpha) ** 2, np.cos(c.alpha) ** 2, np.sin(c.alpha) ** 2
    lifted, beta, N = c.raise_variance, c.stand.beta**2, c.positions
    bias = (c.noise**2 + c.bias_variation**2) / (2 * N) + c.magnitude**2 * cos / (4 * N) * (1 - r3) * beta
    scale = (
        lifted * ((1 - r2) * tan + r2 * (r2 / tan - 2 * (1 - r2)))
        + beta / (2 * N) * ((1 - r2) ** 2 + 1.5 * r2 * (1 - r2) / tan + 2 * r1 * r3)
        + c.noise**2 / (N * c.magnitude**2) * (2 / cos * (1 - r2) + r2 / sin)
    )
    axis = (
        lifted * r2 * (1 - r2) * (tan + 1 / tan + 2)
        + c.stand.theta_y**2 / cos * (1 - r2)
        + beta / (2 * N) * (1.5 * (1 - r2) / tan + (1 - r2) * (3 + r2) - 2 * r1 * r3)
        + c.noise**2 / (N * c.magnitude**2) * (2 / cos * (1 - r2) + (1 - 2 * r2) / (2 * sin))
    )
    return Accuracy(scale, bias, axis)


def checked(axes: Array, c: Conditions) -> Accuracy:
    """The propagation at the head of this file; axes (m, 3), leading axes free, unit vectors, platform axes."""
    r2 = axes[..., 1] ** 2
    tan, cos, sin = np.tan(c.alpha), np.cos(c.alpha) ** 2, np.sin(c.alpha) ** 2
    lifted, beta, N, g = c.raise_variance, c.stand.beta**2, c.positions, c.magnitude
    reading = (c.noise**2 + c.bias_variation**2) / N
    scale = (
        lifted * (r2 / tan - (1 - r2) * tan) ** 2
        + beta / (4 * N) * (1 - r2) * (1 - r2 + r2 / tan**2)
        + reading / g**2 * ((1 - r2) / cos + r2 / (2 * sin))
    )
    axis = (
        lifted * r2 * (1 - r2) * (tan + 1 / tan) ** 2
        + beta / (4 * N) * (1 - r2) * (3 + r2 + (1 - r2) / tan**2)
        + reading / g**2 * ((1 + r2) / cos + (1 - r2) / (2 * sin))
    )
    bias = reading / 2 + beta / (4 * N) * (1 - r2) * g**2 * cos
    return Accuracy(scale, bias, axis)
