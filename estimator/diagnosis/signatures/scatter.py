"""The scatter that a signature must stand out of, where the file states no noise.

The noise is then that of the readings themselves, the signature taken out: F takes the place of χ². Only readings say
how they scatter; how the parameters moved since the history is the signature's own affair.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, fdtrc

from estimator.calibration.noise import with_the_others
from estimator.causes.contract import Shape
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.session import ACCELEROMETER, Array

FAINTEST_TAIL = 1e-280
"""Tail probability below which its logarithm is taken from the ratio itself; doubles end at 1e-308."""


@dataclass(frozen=True, eq=False)
class ReadingScatter:
    """What the findings so far leave of the readings. N reading and prior rows, m sensors."""

    baseline: Baseline
    residual: Array
    """(N,) standard errors."""
    freedom: Array
    """(N,) degrees of freedom of every row."""
    sensor_of_row: Array
    """(N,) int; −1 for priors."""

    def without(self, shapes: Sequence[Shape], basis: Array, along: Array) -> tuple[Array, Array]:
        """(S,) energy and (S,) degrees of freedom of the readings that each of S signatures must stand out of.

        ``basis`` (S, n, q) orthonormal traces, ``along`` (S, q) residual along them, standard errors: both are taken
        out. NaN where the noise is stated. What other sensors of the kind suggest is added, unless the sensor's own
        scatter contradicts it.
        """
        m, unstated = len(self.baseline.unstated), self.baseline.unstated
        sharing = np.zeros((len(shapes), m))
        for k, shape in enumerate(shapes):
            sharing[k, sharing_scatter(self.baseline, shape.sensors)] = 1.0
        unknown = sharing @ unstated > 0
        energy, freedom = np.full(len(shapes), np.nan), np.full(len(shapes), np.nan)
        if unknown.any():
            left = self.of_sensors(basis[unknown], along[unknown])
            one = (sharing[unknown].sum(axis=-1) < m) | np.isinf(self.baseline.row_sigma).any()
            both = np.where(one, self.shared(*left, sharing[unknown]), self.pooled(*left))
            energy[unknown], freedom[unknown] = both
        return energy, freedom

    def of_sensors(self, basis: Array, along: Array) -> tuple[Array, Array]:
        """(S, m) energy and (S, m) degrees of freedom that S signatures leave of each sensor."""
        N = len(self.residual)
        own = self.sensor_of_row[:, None] == np.arange(len(self.baseline.unstated))
        fitted = (basis @ along[..., None])[:, :N, 0]
        used = (basis[:, :N] ** 2).sum(axis=-1)
        return (self.residual - fitted) ** 2 @ own, (self.freedom - used) @ own

    def shared(self, energy: Array, freedom: Array, sharing: Array) -> tuple[Array, Array]:
        """(S,) of the scatter of sensors (S, m) that share the estimate of a row's direction, as of one."""
        one, free = (energy * sharing).sum(axis=-1), (freedom * sharing).sum(axis=-1)
        if self.baseline.expected_ratio is None:
            return one, free
        alone = sharing.sum(axis=-1) == 1
        return with_the_others(one, free, np.where(alone, sharing @ self.baseline.expected_ratio, np.nan))

    def pooled(self, energy: Array, freedom: Array) -> tuple[Array, Array]:
        """(S,) of the scatter that signatures common to all sensors (S, m) stand out of.

        The variance is the mean of the sensors' s², E/f where a sensor's noise is unknown and 1 where it is stated; its
        degrees of freedom are Satterthwaite's, (Σ sᵢ²)² / Σ sᵢ⁴/fᵢ over the unknown. Every sensor counts alike, so that
        rivals are held against one scatter.
        """
        unstated = self.baseline.unstated
        each = np.where(unstated, energy / np.maximum(freedom, 1.0), 1.0)
        doubt = (np.where(unstated, each, 0.0) ** 2 / np.maximum(freedom, 1.0)).sum(axis=-1)
        told = each.sum(axis=-1) ** 2 / np.maximum(doubt, np.finfo(float).tiny)
        return each.mean(axis=-1) * told, told


def sharing_scatter(baseline: Baseline, sensors: tuple[int, ...]) -> list[int]:
    """The sensors out of whose scatter a signature must stand: its own, or all accelerometers that share the estimate
    of a row's direction, since what one of them has moves the residuals of the others."""
    kinds = baseline.setting.kinds
    chosen = list(sensors) or list(range(len(kinds)))
    coupled = [i for i, kind in enumerate(kinds) if kind == ACCELEROMETER]
    if np.isinf(baseline.row_sigma).any() and not set(chosen).isdisjoint(coupled):
        return sorted({*chosen, *coupled})
    return chosen


def equivalent_chi2(power: Array, q: Array, energy: Array, freedom: Array) -> Array:
    """(S,) χ², dimensionless, as unlikely as the ``power`` (S,) that signatures of q (S,) amplitudes explain.

    Where the noise of its sensors is estimated from what it leaves of their readings (``energy`` with ``freedom``,
    (S,); else NaN), F = (power/q)/(energy/freedom) takes the place of χ², carried over at the same tail probability.
    """
    over, amplitudes = np.maximum(freedom, 1.0), np.maximum(q, 1)
    ratio = power / np.maximum(energy, 1e-6 * np.maximum(power, 1e-300))
    tail = fdtrc(amplitudes, over, ratio * over / amplitudes)
    unknown = np.where(
        tail < FAINTEST_TAIL, over * np.log1p(ratio), chdtri(amplitudes, np.maximum(tail, FAINTEST_TAIL))
    )
    return np.where(np.isnan(energy) | (q == 0), power, np.where(freedom > 1, unknown, 0.0))
