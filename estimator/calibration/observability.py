"""The parameters that a session determines of each sensor, and those that it determines only in combination."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.applied_vector import Geometry
from estimator.arrays import eigh
from estimator.forward import projected, slope
from estimator.parameters import ELEMENTS, LIMIT, PLAUSIBLE, SensorParameters
from estimator.results import KnownCombination
from estimator.session import Array

ROUNDING = 1e-14
"""Eigenvalues of the information below this part of the largest are rounding of doubles, not knowledge."""

DEPENDENT = 1e-4
"""Relative singular value below which a combination counts as unobservable: its sigma is 10⁴ times the best one's."""

LINEAR = ("zero_reading", "sensitivity_x", "sensitivity_y", "sensitivity_z", "quadratic_reading")
"""K·b, K·e (block axes) and K·c: what a reading is linear in."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Each sensor's own information, stand perfect, by its principal directions; leading axes are free."""

    values: Array
    """(..., m, 5) rising, dimensionless."""
    vectors: Array
    """(..., m, 5, 5), columns, dimensionless."""

    @cached_property
    def observed(self) -> Array:
        """(m, 5) bool, leading axes free; the axis needs both elements, and the scale needs the axis.

        An axis off by δ rad out of the plane that the rows reach changes the scale by δ²/2, which the information at
        the solution does not show.
        """
        variance = (self.vectors**2 / (self.values + PLAUSIBLE**-2)[..., None, :]).sum(axis=-1)
        seen = variance < LIMIT**2
        seen[..., 3:] = seen[..., 3:].all(axis=-1, keepdims=True)
        seen[..., 0] &= seen[..., 3]
        return seen

    @cached_property
    def rank(self) -> Array:
        """The number of parameter directions that the readings determine: (S,), or whatever the leading axes are."""
        return (self.values > LIMIT**-2).sum(axis=(-1, -2))

    @property
    def weakest(self) -> tuple[Array, Array, Array]:
        """Sensor (S,) and element (S,) that lead the least known direction, and its sigma (S,), relative."""
        sensor = self.values[..., 0].argmin(axis=-1)
        least = np.take_along_axis(self.values[..., 0], sensor[..., None], axis=-1)[..., 0]
        lead = np.take_along_axis(np.abs(self.vectors[..., 0]).argmax(axis=-1), sensor[..., None], axis=-1)[..., 0]
        return sensor, lead, 1.0 / (PLAUSIBLE * np.sqrt(np.maximum(least, 1e-12)))


def spectrum(information: Array) -> Spectrum:
    """Principal directions of the information (m, 5, 5), leading axes free, of dimensionless elements."""
    values, vectors = eigh(information)
    return Spectrum(np.where(values < ROUNDING * values[..., -1:], 0.0, values), vectors)


def known_bias_quadratic(information: Array, bias: float, quadratic: float, norm: float) -> KnownCombination | None:
    """The known mixture b + ratio·c where the two cannot be distinguished; None where that is not known either.

    Parameters
    ----------
    information : (5, 5) of the sensor, dimensionless.
    bias, quadratic : SI, at the solution.
    norm : length of the applied vector, m/s² (rad/s).
    """
    values, vectors = eigh(information[1:3, 1:3])
    if values[1] < LIMIT**-2:
        return None
    strong, others = vectors[:, 1], [0, 3, 4]
    cross = information[np.ix_(others, [1, 2])] @ strong
    information_left = values[1] - cross @ np.linalg.solve(information[np.ix_(others, others)], cross)
    ratio = float(strong[1] / strong[0]) * norm**2
    sigma = norm / (np.sqrt(information_left) * abs(float(strong[0])))
    return KnownCombination({ELEMENTS[1]: 1.0, ELEMENTS[2]: ratio}, bias + ratio * quadratic, float(sigma))


def known_linear(
    y: Array, variance: Array, p: SensorParameters, geometry: Geometry, sensor: int
) -> tuple[KnownCombination, ...]:
    """Combinations of the `LINEAR` quantities that one sensor's rows determine; sigma counts the stand's errors.

    Parameters
    ----------
    y : (R,) readings, offset taken off, reading units.
    variance : (R,) of the independent noise at the input, (m/s²)² or (rad/s)².
    p : (m,) parameters at the solution: scale for the noise, axis for the column of the quadratic term.
    """
    K, norm, n = p.scale[sensor], geometry.norm[sensor], geometry.n[:, sensor]
    steep = (slope(p, geometry.n) * K)[:, sensor]
    swing = steep * projected(p.axis, geometry.beta)[:, sensor] * geometry.beta_sigma
    root = 1.0 / np.sqrt(K**2 * variance + swing**2)
    ones, a = np.ones_like(y), n @ p.axis[sensor]
    left, size, right = np.linalg.svd(
        np.column_stack([ones, n / norm, (a / norm) ** 2]) * root[:, None], full_matrices=False
    )
    determined = size > DEPENDENT * size[0]
    sums = left.T[determined] * root / size[determined, None]
    common = (geometry.constant[:, :, sensor] @ p.axis[sensor]) * steep * geometry.constant_sigma[:, None]
    sigma = np.sqrt(size[determined] ** -2.0 + ((sums @ common.T) ** 2).sum(axis=1))
    weights = right[determined] * np.array([1.0, norm, norm, norm, norm**2])
    return tuple(
        KnownCombination(dict(zip(LINEAR, map(float, w), strict=True)), float(v), float(s))
        for w, v, s in zip(weights, sums @ y, sigma, strict=True)
    )
