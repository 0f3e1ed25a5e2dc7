"""The scatter that a signature must stand out of, where the file states no noise.

The noise is then that of the readings themselves, the signature taken out: F takes the place of χ². Only readings say
how they scatter; how the parameters moved since the history is the signature's own affair.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, fdtrc

from estimator.calibration.noise import with_the_others
from estimator.causes import Shape
from estimator.diagnosis.residuals.whitened import Evidence
from estimator.session import ACCELEROMETER, Array

FAINTEST_TAIL = 1e-280
"""Tail probability below which its logarithm is taken from the residuals themselves."""


@dataclass(frozen=True, eq=False)
class Left:
    """What the findings so far leave of the evidence."""

    evidence: Evidence
    taken: Array
    """(n, f) orthonormal traces of the findings."""
    z: Array
    """(n,)"""

    @classmethod
    def of(cls, evidence: Evidence, taken: Array) -> "Left":
        return cls(evidence, taken, evidence.z - taken @ (taken.T @ evidence.z))

    def scatter(self, shapes: Sequence[Shape], basis: Array, along: Array) -> tuple[Array, Array]:
        """(S,) energy and degrees of freedom of the readings that each signature must stand out of, it taken out.

        ``basis`` (S, n, q) orthonormal traces, ``along`` (S, q) what is left along them. NaN where the noise is stated.
        What other sensors of the kind let expect is added where the sensor's own scatter does not gainsay it.
        """
        evidence = self.evidence
        m = len(evidence.baseline.unstated)
        owners = np.zeros((len(shapes), m))
        for k, shape in enumerate(shapes):
            owners[k, sharing(evidence, shape.sensors)] = 1.0
        unknown = owners @ evidence.baseline.unstated > 0
        energy, freedom = np.full(len(shapes), np.nan), np.full(len(shapes), np.nan)
        if not unknown.any():
            return energy, freedom
        own = evidence.owner[: evidence.readings, None] == np.arange(m)
        fitted = (basis[unknown] @ along[unknown, :, None])[:, : evidence.readings, 0]
        used = (basis[unknown, : evidence.readings] ** 2).sum(axis=-1)
        spare = evidence.spare - (self.taken[: evidence.readings] ** 2).sum(axis=-1)
        energy[unknown] = (((self.z[: evidence.readings] - fitted) ** 2 @ own) * owners[unknown]).sum(axis=-1)
        freedom[unknown] = (((spare - used) @ own) * owners[unknown]).sum(axis=-1)
        if evidence.baseline.expected is None:
            return energy, freedom
        expected = np.where(owners.sum(axis=-1) == 1, owners @ evidence.baseline.expected, np.nan)
        return with_the_others(energy, freedom, expected)


def sharing(evidence: Evidence, sensors: tuple[int, ...]) -> list[int]:
    """The sensors out of whose scatter a signature must stand: its own, or all accelerometers that share the estimate
    of a row's direction, since what one of them has moves the left-over of the others."""
    setting = evidence.baseline.setting
    chosen = list(sensors) or list(range(len(setting.kinds)))
    coupled = [i for i, kind in enumerate(setting.kinds) if kind == ACCELEROMETER]
    if np.isinf(evidence.baseline.row_sigma).any() and not set(chosen).isdisjoint(coupled):
        return sorted({*chosen, *coupled})
    return chosen


def equivalent(power: Array, q: Array, energy: Array, freedom: Array) -> Array:
    """(S,) χ² of signatures that are as unlikely as the power (S,) that each takes out with its q (S,) amplitudes.

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
