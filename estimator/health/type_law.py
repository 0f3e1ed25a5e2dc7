"""A temperature law from a unit's own sessions and from the laws of other sensors of its type.

Of a sensor's bias or scale, f(T) = b·(T − T₀) + c·(T − T₀)² with (b, c) ~ N(μ, diag s²) over the sensors of a type, and
the scatter τ about it with the chances that the type gives it: empirical Bayes, else as `temperature_law`. With the
columns B that act whatever else does, β flat, at every τ of `SCATTERS`

    y = Bβ + Xθ + e,   V = diag(σ² + τ²),   M = [B X]ᵀV⁻¹[B X] + diag(0, s⁻²),
    −2 ln L(τ) = ln|V| + ln|M| + yᵀV⁻¹y + μᵀ(μ/s²) − ŝᵀMŝ                               (Harville 1974)

The worth of a step is the mean over τ of its means. Its variance v has a mean E and a variance over τ: those of an
inverse χ² of ν = 4 + 2E²/var v degrees of freedom and scale E(ν − 2)/ν, so the worth has Student's t of these.
"""

from dataclasses import dataclass

import numpy as np

from estimator.health.fits import LEAST, Readings
from estimator.session import Array

SCATTERS = np.concatenate([[0.0], np.geomspace(0.01, 3.0, 24)])
"""(K,) τ, T: from what is not seen to what spoils every session."""
ENOUGH_WITH_TYPE = 4
"""Sessions at least where the type supplies the rest: level, a change through time, and two numbers beside."""
DEPENDENT = 1e-10
"""Eigenvalue of scaled columns below which one of them is a mix of the others."""
KNOWN = 1e-6
"""Relative variance of a variance below which it is known."""


Scattered = tuple[Array, Array, Array]


@dataclass(frozen=True)
class TypeLaw:
    """The distribution of the temperature laws of a type's sensors, for one parameter."""

    kind: str
    """Kind of sensor."""
    parameter: str
    """`scale` or `bias`."""
    tolerance: float
    """T of what follows: relative for scale, else SI."""
    about: float
    """°C, T₀."""
    mean: tuple[float, float]
    """μ, T per °C and T per °C²."""
    sigma: tuple[float, float]
    """s, the same units: one sigma of one more sensor of the type."""
    scatter: tuple[float, ...]
    """Chance of every τ of `SCATTERS`: of none, and of 24 from 0.01 T to 3 T in equal ratios."""
    sensors: int
    """Number of sensors it was learned from."""
    units: int
    """Number of units it was learned from."""

    @property
    def usual_scatter(self) -> float:
        """Scatter that half of the sensors do not exceed, T."""
        return float(SCATTERS[np.searchsorted(np.cumsum(self.scatter), 0.5)])


def columns_about(celsius: Array, about: float) -> Array:
    """(n, 2) °C from T₀ and their squares, °C²."""
    away = celsius - about
    return np.stack([away, away**2], axis=1)


def fit_at_every_scatter(readings: Readings, columns: Array, law: TypeLaw | None = None) -> Scattered:
    """Sizes (K, p) of the readings' base and of columns (n, 2), last, T per unit of each, their covariances (K, p, p)
    and restricted log likelihoods (K,), at every τ; flat where no law says what these are.

    Parameters
    ----------
    readings : of one component, in the tolerances of the law.
    """
    design, y = np.concatenate([readings.base, columns], axis=1), readings.value[:, 0]
    free = design.shape[1] - columns.shape[1]
    known = np.zeros(columns.shape[1]) if law is None else np.array(law.sigma) ** -2.0
    mean = np.zeros(columns.shape[1]) if law is None else np.array(law.mean)
    added = np.concatenate([np.zeros(free), known])
    variance = np.maximum(readings.sigma[:, 0], LEAST) ** 2 + SCATTERS[:, None] ** 2
    weighted = design / variance[..., None]
    information = np.swapaxes(weighted, -1, -2) @ design + np.diag(added)
    score = np.swapaxes(weighted, -1, -2) @ y + np.concatenate([np.zeros(free), known * mean])
    covariance, determinant = _inverted(information)
    size = (covariance @ score[..., None])[..., 0]
    left = (y**2 / variance).sum(axis=1) + mean @ (known * mean) - (score * size).sum(axis=1)
    cost = np.log(variance).sum(axis=1) + determinant + left
    return size, covariance, -cost / 2


def _inverted(information: Array) -> tuple[Array, Array]:
    """(K, p, p) inverses of matrices and (K,) logs of their determinants, each of what is seen: a column that stands
    twice is one. Columns are scaled to 1 first, since their units are far apart."""
    root = np.sqrt(np.einsum("kpp->kp", information))
    scale = root[:, :, None] * root[:, None, :]
    kept, axes = np.linalg.eigh(information / scale)
    kept = np.where(kept > DEPENDENT, kept, np.inf)
    inverse = (axes / kept[:, None, :]) @ np.swapaxes(axes, -1, -2) / scale
    seen = np.where(np.isfinite(kept), kept, 1.0)
    return inverse, np.asarray(np.log(seen).sum(axis=1) + 2 * np.log(root).sum(axis=1))


def chances(log_likelihood: Array, prior: Array) -> Array:
    """(..., K) posterior chances of every τ, by log likelihoods (..., K) and prior chances (K,)."""
    share = prior * np.exp(log_likelihood - log_likelihood.max(axis=-1, keepdims=True))
    return np.asarray(share / share.sum(axis=-1, keepdims=True))


def worth_by(
    readings: Readings, celsius: Array, law: TypeLaw, between: tuple[float, float]
) -> tuple[float, float, float | None]:
    """Worth, T of the law, its variance, T², and degrees of freedom of going from one temperature to another, °C.

    A session and its reference each lie off the law by τ.
    """
    size, covariance, logs = fit_at_every_scatter(readings, columns_about(celsius, law.about), law)
    start, stop = columns_about(np.array(between), law.about)
    along = np.concatenate([np.zeros(size.shape[1] - 2), stop - start])
    share = chances(logs, np.array(law.scatter))
    worths = size @ along
    worth = float(share @ worths)
    variances = np.einsum("p,kpq,q->k", along, covariance, along) + 2 * SCATTERS**2 + (worths - worth) ** 2
    variance = float(share @ variances)
    apart = float(share @ (variances - variance) ** 2)
    if apart <= KNOWN * variance**2:
        return worth, variance, None
    dof = 4 + 2 * variance**2 / apart
    return worth, variance * (dof - 2) / dof, dof
