"""What a session determines of each sensor, and what it determines only in combination."""

import numpy as np

from estimator.parameters import ELEMENTS, PLAUSIBLE
from estimator.results import KnownCombination
from estimator.session import Array

LIMIT = 0.3 * PLAUSIBLE
"""An element counts as observed when its dimensionless one sigma is below this share of what it could be at all."""

ONLY_TOGETHER = {"bias", "quadratic"}


def observed(information: Array) -> Array:
    """(..., 5) bool from each sensor's own information (..., 5, 5); the axis needs both of its elements."""
    bounded = information + np.eye(5) * PLAUSIBLE**-2
    sigma = np.sqrt(np.diagonal(np.linalg.inv(bounded), axis1=-2, axis2=-1))
    seen = sigma < LIMIT
    seen[..., 3:] = seen[..., 3:].all(axis=-1, keepdims=True)
    return seen


def known_bias_quadratic(information: Array, values: Array, norm: float) -> tuple[KnownCombination, ...]:
    """The known mixture of bias and quadratic where the two cannot be told apart: b + ratio·c.

    Parameters
    ----------
    information : (5, 5) of the sensor, dimensionless.
    values : (5,) SI values at the solution (axis elements unused).
    norm : length of the reference vector.
    """
    values_, vectors = np.linalg.eigh(information[1:3, 1:3])
    if values_[1] < LIMIT**-2:
        return ()
    strong = vectors[:, 1] / vectors[0, 1]
    ratio = float(strong[1]) * norm**2
    others = [0, 3, 4]
    cross = information[np.ix_(others, [1, 2])] @ vectors[:, 1]
    left = values_[1] - cross @ np.linalg.solve(information[np.ix_(others, others)], cross)
    sigma = norm / (np.sqrt(left) * abs(float(vectors[0, 1])))
    return (KnownCombination({"bias": 1.0, "quadratic": ratio}, float(values[1] + ratio * values[2]), float(sigma)),)


def known_linear(y: Array, variance: Array, n: Array, norm: float) -> tuple[KnownCombination, ...]:
    """Combinations of zero reading K·b and sensitivity K·e that the rows determine, quadratic term apart.

    y (R,) readings, variance (R,) of them, n (R, 3).
    """
    design = np.concatenate([np.ones((len(n), 1)), n / norm], axis=1) / np.sqrt(variance)[:, None]
    left, size, right = np.linalg.svd(design, full_matrices=False)
    kept = size > 1e-6 * size[0]
    combinations = []
    for u, s, v in zip(left.T[kept], size[kept], right[kept], strict=True):
        coefficients = dict(
            zip(
                ("zero_reading", "sensitivity_x", "sensitivity_y", "sensitivity_z"),
                map(float, v),
                strict=True,
            )
        )
        for axis in "xyz":
            coefficients[f"sensitivity_{axis}"] *= norm
        combinations.append(KnownCombination(coefficients, float(u @ (y / np.sqrt(variance)) / s), float(1 / s)))
    return tuple(combinations)


def weakest(information: Array, names: tuple[str, ...]) -> tuple[str, float]:
    """The least known direction of a block: leading parameter and one sigma in units of the plausible range."""
    values, vectors = np.linalg.eigh(information)
    sensor = int(np.argmin(values[:, 0]))
    lead = ELEMENTS[int(np.abs(vectors[sensor, :, 0]).argmax())]
    least = max(float(values[sensor, 0]), 1e-300)
    return f"{names[sensor]}.{lead}", float(min(1 / np.sqrt(least), 1e6) / PLAUSIBLE)
