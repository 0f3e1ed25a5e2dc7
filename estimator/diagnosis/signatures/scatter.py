"""The scatter that a signature must stand out of, where the file states no noise.

The noise is then that of the readings themselves, the signature taken out: F takes the place of χ². Only readings say
how they scatter; how the parameters moved since the history is the signature's own affair.
"""

import numpy as np

from estimator.calibration.noise import with_the_others
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.session import ACCELEROMETER, Array


def reference_scatter(baseline: Baseline, sensor: Array, energy: Array, freedom: Array) -> tuple[Array, Array]:
    """(S,) energy and (S,) degrees of freedom of the readings that each of S signatures must stand out of.

    ``sensor`` (S,) int that each is blamed on, −1 for none; ``energy`` (S, m), dimensionless, and ``freedom`` (S, m)
    that each leaves of every sensor. What other sensors of the kind suggest is added, unless the sensor's own scatter
    contradicts it.
    """
    sharing = sharing_scatter(baseline)[sensor]
    is_shared = (sharing.sum(axis=-1) < len(baseline.unstated)) | np.isinf(baseline.row_sigma).any()
    both = np.where(is_shared, shared(baseline, energy, freedom, sharing), pooled(baseline, energy, freedom))
    return both[0], both[1]


def in_unknown_noise(baseline: Baseline, sensor: Array) -> Array:
    """(S,) bool: whether signatures blamed on ``sensor`` (S,) int, −1 for none, have readings of unstated noise."""
    return np.asarray((sharing_scatter(baseline) @ baseline.unstated > 0)[sensor])


def shared(baseline: Baseline, energy: Array, freedom: Array, sharing: Array) -> tuple[Array, Array]:
    """(S,) energy and degrees of freedom of the scatter of sensors (S, m) that share the estimate of a row's direction,
    as of one.
    """
    total, free = (energy * sharing).sum(axis=-1), (freedom * sharing).sum(axis=-1)
    if baseline.expected_ratio is None:
        return total, free
    alone = sharing.sum(axis=-1) == 1
    return with_the_others(total, free, np.where(alone, sharing @ baseline.expected_ratio, np.nan))


def pooled(baseline: Baseline, energy: Array, freedom: Array) -> tuple[Array, Array]:
    """(S,) energy and degrees of freedom of the scatter that signatures common to all sensors (S, m) stand out of.

    The variance is the mean of the sensors' s², E/f where a sensor's noise is unknown and 1 where it is stated; its
    degrees of freedom are Satterthwaite's, (Σ sᵢ²)² / Σ sᵢ⁴/fᵢ over the unknown. Every sensor counts alike, so that
    rivals are held against one scatter.
    """
    unstated = baseline.unstated
    each = np.where(unstated, energy / np.maximum(freedom, 1.0), 1.0)
    doubt = (np.where(unstated, each, 0.0) ** 2 / np.maximum(freedom, 1.0)).sum(axis=-1)
    effective = each.sum(axis=-1) ** 2 / np.maximum(doubt, np.finfo(float).tiny)
    return each.mean(axis=-1) * effective, effective


def sharing_scatter(baseline: Baseline) -> Array:
    """(m + 1, m) 1 for the sensors out of whose scatter a signature of each sensor, and at last one of none, must
    stand, else 0.

    Its own, or all accelerometers that share the estimate of a row's direction, since what one of them has moves the
    residuals of the others.
    """
    m = len(baseline.unstated)
    sharing = np.concatenate([np.eye(m), np.ones((1, m))])
    if np.isinf(baseline.row_sigma).any():
        coupled = np.array([kind == ACCELEROMETER for kind in baseline.setting.kinds])
        sharing[np.ix_(np.append(coupled, coupled.any()), coupled)] = 1.0
    return sharing
