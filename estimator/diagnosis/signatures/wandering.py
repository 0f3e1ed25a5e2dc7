"""Every zero wanders by itself, or the block turns: what an event that sensors share is held against.

Theory
------
Where all sensors drift, each in its own way, there is always some row at which a step of several of them explains
much. So the zero of every sensor is given a course of its own, all with one spread in its standard errors: a random
walk, or a rate that walks. With X the whitened traces of the courses' leading waves, what the calibration absorbs
projected out, and amplitudes N(0, g),

    ln B = ½ z'X(X'X + I/g)⁻¹X'z − ½ ln|I + g·X'X|,        mean over g

against no effect in known noise. In noise known up to a factor from ν degrees of freedom, with Q twice the first term,
it is −½ ν ln(1 − Q/z'z) instead. The same of the three amplitudes of a block that turned before one of the rows, a
mean over rows: every sensor shows that too, by its axis.
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import eigh
from estimator.causes.fixture import turned
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.traces import INVISIBLE
from estimator.session import Array

SPREADS = 4.0 ** np.arange(-3, 9)
"""g: from an eighth of a standard error, which hundreds of readings together may tell, to 256; all equally likely."""

WAVES = 12
"""Leading waves of a course that are kept: of a random walk they hold 97 %."""


def log_wandering(residuals: WhitenedResiduals) -> float:
    """ln evidence of courses of all zeros, each its own, against no effect; the likelier kind of course."""
    variance = residuals.baseline.variance
    rows, m = variance.shape
    values = []
    for waves in (walk(rows), walking_rate(rows)):
        columns = np.zeros((rows, m, m, waves.shape[1]))
        columns[:, np.arange(m), np.arange(m)] = waves[:, None, :] * np.sqrt(variance)[..., None]
        trace = residuals.trace(columns.reshape(rows, m, -1), 0.0)
        values.append(log_mean(log_marginal(residuals, trace, SPREADS)))
    return max(values)


def log_turning(residuals: WhitenedResiduals, sizes: Array) -> float:
    """ln evidence of a block that turned before one of the rows against no effect; ``sizes`` (G,) g."""
    setting, values = residuals.baseline.setting, []
    whole = setting.through(turned(setting.n))
    for row in range(1, setting.rows):
        trace = residuals.trace(whole * (np.arange(setting.rows) >= row)[:, None, None], 0.0)
        size = np.linalg.norm(trace, axis=0)
        seen = size > INVISIBLE * np.linalg.norm(residuals.whitened(whole), axis=0)
        values.append(log_mean(log_marginal(residuals, trace[:, seen] / size[seen], sizes)) if seen.any() else 0.0)
    return log_mean(np.array(values))


def log_marginal(residuals: WhitenedResiduals, trace: Array, sizes: Array) -> Array:
    """(G,) ln evidence of amplitudes N(0, g) of traces (n, q), standard errors, against no effect; ``sizes`` (G,)."""
    power, size = marginal(trace.T @ trace, trace.T @ residuals.z, sizes)
    if residuals.baseline.unstated.any():
        share = np.minimum(power / float(residuals.z @ residuals.z), 1 - 1e-12)
        return np.asarray(-0.5 * residuals.freedom * np.log1p(-share) - 0.5 * size)
    return np.asarray(0.5 * (power - size))


def marginal(gram: Array, along: Array, sizes: Array) -> tuple[Array, Array]:
    """(G,) z'X(X'X + I/g)⁻¹X'z and (G,) ln|I + g·X'X| of traces with products ``gram`` (q, q) and ``along`` (q,)."""
    square, turn = eigh(gram)
    grown = 1 + sizes[:, None] * np.maximum(square, 0.0)
    power = (sizes[:, None] * (turn.T @ along) ** 2 / grown).sum(axis=1)
    return np.asarray(power), np.asarray(np.log(grown).sum(axis=1))


def log_mean(values: Sequence[float] | Array) -> float:
    """ln of the mean of what values (G,) are the ln of."""
    return float(np.logaddexp.reduce(values) - np.log(len(values)))


def walk(rows: int) -> Array:
    """(R, w) waves of a random walk over the rows, of mean square one together."""
    t = np.arange(1, rows + 1) / rows
    return leading(np.minimum.outer(t, t))


def walking_rate(rows: int) -> Array:
    """(R, w) the same of a zero whose rate walks."""
    t = np.arange(1, rows + 1) / rows
    first, last = np.minimum.outer(t, t), np.maximum.outer(t, t)
    return leading(first**2 * (last / 2 - first / 6))


def leading(covariance: Array) -> Array:
    """(R, w) the strongest waves of a covariance (R, R) about its mean."""
    about = covariance - covariance.mean(axis=0) - covariance.mean(axis=1)[:, None] + covariance.mean()
    size, wave = eigh(about * len(about) / np.trace(about))
    return np.asarray(wave[:, -WAVES:] * np.sqrt(np.maximum(size[-WAVES:], 0.0)))
