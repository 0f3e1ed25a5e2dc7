"""Predicts each reading where readings are linear in known functions: a robust regression a sensor.

A least absolute deviations start, whose breakdown does not hang on the size of what is wrong, then least squares over
the readings that agree, each held against the fit without it, until none changes sides. Residuals are deletion
residuals: the reading's own leverage is taken off, so that a reading that pulls the fit to itself stands out too.
Source: Cook & Weisberg 1982, Residuals and Influence in Regression, 2.2; Schlossmacher 1973, JASA 68, 857.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from estimator.calibration.analytic import VANISHES
from estimator.session import Array, CalibrationSession

AGREES = 5.0
"""Standard errors within which a reading agrees with the fit: chance leaves it once in a million."""

SUSPICIOUS = 4.0
"""Standard errors of the largest residual, and times the stated variance, from which a robust fit is worth its time."""

RARE = 1e-3
"""Chance of a largest residual from which it is, too."""

STEPS = 40
"""Rounds of reweighting towards least absolute deviations; half of them are usual."""

ROUNDS = 20
"""Rounds of readings changing sides; a handful is usual."""

HALF = 0.6745
"""Standard deviations that half of all normal deviations lie within."""

EXACT = 1e-9
"""Least scatter relative to the range of readings: simulated ones may have none."""

DIGITS, WRITTEN = 9, 0.9
"""Decimals to which readings may be rounded, and part of them that shows it: a wrong one may have more."""

TAKEN = 1e-6
"""Part of a reading's variance below which the fit leaves none of it to judge by."""

FREEDOM = 2
"""Degrees of freedom below which the agreeing readings tell no scatter."""


@dataclass(frozen=True, eq=False)
class Predicted:
    """Prediction of each reading by all others that agree. R rows, m sensors."""

    value: Array
    """(R, m) reading units; NaN where nothing tells it."""
    sigma: Array
    """(R, m) one sigma of the reading less the value; NaN likewise."""
    t: Array
    """(R, m) reading less value in sigmas; NaN likewise."""

    def with_sensors(self, which: Array, part: "Predicted") -> "Predicted":
        """The prediction with that of k sensors, ``which`` (m,) bool, replaced by ``part``, of shape (R, k)."""
        merged = [a.copy() for a in (self.value, self.sigma, self.t)]
        for whole, own in zip(merged, (part.value, part.sigma, part.t), strict=True):
            whole[:, which] = own
        return Predicted(*merged)

    def shifted(self, offset: Array) -> "Predicted":
        """The prediction of readings with an ``offset`` (m,), reading units, on top."""
        return Predicted(self.value + offset, self.sigma, self.t)


def nothing_predicted(readings: Array) -> Predicted:
    """The prediction where nothing is known of readings (R, m) of any unit."""
    return Predicted(*(np.full(readings.shape, np.nan) for _ in range(3)))


def harmonics(session: CalibrationSession) -> Array:
    """(R, p) functions of β that every reading on a stand is linear in, whatever axes, nonlinearity and stand errors:
    up to the second harmonic in each run, and where that would take more than half of the rows those that a quadratic
    sensor needs, `analytic.design`."""
    assert session.beta is not None
    assert session.flipped is not None
    beta, run = session.beta, np.where(session.flipped, -1.0, 1.0)
    even = np.stack([np.ones_like(beta), np.sin(beta), np.cos(beta), np.cos(2 * beta), np.sin(2 * beta)], axis=-1)
    free = live(np.column_stack([even, run[:, None] * even]))
    if 2 * free.shape[1] <= len(beta):
        return free
    return live(np.column_stack([even[:, :4], run[:, None] * even[:, [0, 1, 2, 4]]]))


def live(columns: Array) -> Array:
    """(R, q) orthonormal basis of columns (R, p), without those that the rows hardly distinguish."""
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, size > VANISHES * size[0]])


def sticks_out(basis: Array, y: Array, stated: Array) -> Array:
    """(..., m) bool: sensors among whose readings y (..., R, m) one stands out of a plain fit in a basis (R, p) by the
    others' scatter, several do by the scatter of the middle ones, or whose fit leaves more than the ``stated`` (..., R,
    m) standard errors, NaN where there are none."""
    R, p = basis.shape
    if R - p < FREEDOM:
        return np.zeros((*y.shape[:-2], y.shape[-1]), dtype=bool)
    rest = y - basis @ (basis.T @ y)
    size = np.abs(rest) / np.sqrt(np.maximum(1.0 - (basis**2).sum(axis=1)[:, None], TAKEN))
    total, largest = (rest**2).sum(axis=-2), size.max(axis=-2)
    noise = np.nan_to_num(np.median(stated, axis=-2))
    usual = np.maximum(np.sort(size, axis=-2)[..., (R + p) // 2, :] / HALF, noise)
    remaining = np.maximum(total - largest**2, (TAKEN * largest) ** 2 + np.finfo(float).tiny)
    spread = np.maximum(np.sqrt(remaining / (R - p - 1)), noise)
    rare = largest > spread * stdtrit(R - p - 1, 1.0 - RARE / (2 * R))
    excess = (noise > 0) & (total > SUSPICIOUS * noise**2 * (R - p))
    return np.asarray(rare & (largest > 0) | (largest > SUSPICIOUS * usual) | excess)


def regression(basis: Array, y: Array, stated: Array, left_out: Array) -> Predicted:
    """Predicts readings y (R, m) in a basis (R, p), with ``stated`` (R, m) standard errors, NaN where there are none;
    readings ``left_out`` (R, m) bool take no part to begin with.
    """
    parts = [of_one(basis, y[:, i], stated[:, i], ~left_out[:, i]) for i in range(y.shape[1])]
    value, sigma = (np.stack(columns, axis=1) for columns in zip(*parts, strict=True))
    with np.errstate(invalid="ignore"):
        return Predicted(value, sigma, (y - value) / sigma)


def of_one(basis: Array, y: Array, stated: Array, free: Array) -> tuple[Array, Array]:
    """(R,) predictions of a sensor's readings y (R,), and one sigma of the difference."""
    nothing = np.full(len(y), np.nan), np.full(len(y), np.nan)
    known = bool(np.isfinite(stated).all() and (stated > 0).all())
    weight = 1.0 / stated if known else np.ones(len(y))
    design, z = basis * weight[:, None], y * weight
    floor = 1.0 if known else max(EXACT * float(np.ptp(y)), rounding(y), np.finfo(float).tiny)
    rank = np.linalg.matrix_rank(design[free], rtol=VANISHES) if free.any() else 0
    if rank < design.shape[1] or free.sum() - rank < FREEDOM:
        return nothing
    rest = z - design @ least_absolute(design[free], z[free])
    middle = np.sort(np.abs(rest[free]))[(int(free.sum()) + rank) // 2]
    agrees = free & (np.abs(rest) <= AGREES * max(middle / HALF, floor))
    seen: set[bytes] = set()
    for _ in range(ROUNDS):
        found = deletion(design, z, agrees, floor)
        if found is None:
            return nothing
        value, sigma = found
        seen.add(agrees.tobytes())
        with np.errstate(invalid="ignore"):
            now = np.abs(z - value) <= AGREES * sigma
        if now.tobytes() in seen:
            break
        agrees = now
    return value / weight, sigma / weight


def rounding(y: Array) -> float:
    """One sigma of the rounding of readings y (n,) to whole counts or to decimals; 0 where they are not rounded."""
    for digits in range(DIGITS + 1):
        scaled = y * 10.0**digits
        if np.mean(np.abs(scaled - np.round(scaled)) <= EXACT * np.abs(scaled)) >= WRITTEN:
            return float(10.0**-digits / np.sqrt(12))
    return 0.0


def deletion(design: Array, z: Array, agrees: Array, floor: float) -> tuple[Array, Array] | None:
    """(R,) prediction of each of z (R,) by the agreeing readings without it, and one sigma of the difference; None
    where they do not determine it. ``floor``: least one sigma of a reading."""
    freedom = int(agrees.sum()) - design.shape[1]
    if freedom < FREEDOM:
        return None
    inverse = np.linalg.pinv(design[agrees])
    leverage = ((design @ inverse @ inverse.T) * design).sum(axis=1)
    fitted = design @ (inverse @ z[agrees])
    rest = z - fitted
    left = np.where(agrees, 1.0 - leverage, 1.0)
    judged = left > TAKEN
    left = np.where(judged, left, 1.0)
    squares = float((rest[agrees] ** 2).sum())
    without = np.where(agrees, (squares - rest**2 / left) / max(freedom - 1, 1), squares / freedom)
    spread = np.where(agrees, 1.0 / left, 1.0 + leverage)
    value = np.where(agrees, z - rest / left, fitted)
    sigma = np.sqrt(np.maximum(without, floor**2) * spread)
    return np.where(judged, value, np.nan), np.where(judged, sigma, np.nan)


def least_absolute(design: Array, z: Array) -> Array:
    """(p,) coefficients of least absolute deviations of z (n,), by reweighted least squares."""
    weight = np.ones(len(z))
    for step in range(STEPS):
        solution = np.linalg.lstsq(design * weight[:, None], z * weight, rcond=None)[0]
        rest = np.abs(z - design @ solution)
        least = float(rest.max()) * 0.5**step + np.finfo(float).tiny
        weight = 1.0 / np.sqrt(np.maximum(rest, least))
        weight /= weight.max()
    return np.asarray(solution)
