"""Rivals of an event that sensors share: every zero wanders by itself, or the block turns.

Theory
------
Where all sensors drift, each in its own way, there is always some row at which a step of several of them explains
much. So the zero of every sensor is given a course of its own, all with one spread in its standard errors: a random
walk, or a rate that walks. With X the whitened traces of the courses' leading waves, what the calibration absorbs
projected out, and amplitudes N(0, g),

    ln B = ½ z'X(X'X + I/g)⁻¹X'z − ½ ln|I + g·X'X|,        mean over g

against no effect in known noise. In noise known up to a factor from ν degrees of freedom, with Q twice the first term,
it is −½ ν ln(1 − Q/z'z) instead. Traces of a course that sensors share are weighed beside the waves with the inverse of
1 + g·XX' in place of the noise, which the eigenvectors of X'X give for every g at once. The same of the three
amplitudes of a block that turned before one of the rows, a mean over rows: every sensor shows that too, by its axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.causes.fixture import turned
from estimator.causes.shared import KINDS
from estimator.content import once
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.traces import INVISIBLE
from estimator.session import Array

SPREADS = 4.0 ** np.arange(-3, 9)
"""g: from an eighth of a standard error, which hundreds of readings together may tell, to 256; all equally likely."""


@dataclass(frozen=True, eq=False)
class Wandering:
    """The waves of all zeros in one session, of one kind of course. q waves of all sensors, n rows."""

    trace: Array
    """(n, q) standard errors."""
    square: Array
    """(q,) eigenvalues of X'X."""
    turn: Array
    """(q, q) eigenvectors of X'X."""
    along: Array
    """(q,) X'z along them."""

    @classmethod
    def of(cls, residuals: WhitenedResiduals, waves: Array) -> "Wandering":
        """The wandering in which every sensor has the same ``waves`` (R, w), dimensionless, in its standard errors."""
        variance = residuals.baseline.variance
        rows, m = variance.shape
        columns = np.zeros((rows, m, m, waves.shape[1]))
        columns[:, np.arange(m), np.arange(m)] = waves[:, None, :] * np.sqrt(variance)[..., None]
        trace = residuals.trace(columns.reshape(rows, m, -1), 0.0)
        square, turn = eigh(trace.T @ trace)
        return cls(trace, np.maximum(square, 0.0), turn, turn.T @ (trace.T @ residuals.z))

    def power_and_size(self) -> tuple[Array, Array]:
        """(G,) z'X(X'X + I/g)⁻¹X'z and (G,) ln|I + g·X'X| at every one of `SPREADS`."""
        grown = 1 + SPREADS[:, None] * self.square
        return (SPREADS[:, None] * self.along**2 / grown).sum(axis=1), np.log(grown).sum(axis=1)

    def beside(self, z: Array, trace: Array, sizes: Array) -> tuple[Array, Array]:
        """(G, S) contributions of traces (n, k) of amplitudes N(0, s), ``sizes`` (S,), to both at every spread."""
        cross, gram, along = self.turn.T @ (self.trace.T @ trace), trace.T @ trace, trace.T @ z
        shrunk = SPREADS[:, None] / (1 + SPREADS[:, None] * self.square)
        pairs = [
            marginal(gram - cross.T @ (s[:, None] * cross), along - cross.T @ (s * self.along), sizes) for s in shrunk
        ]
        power, size = zip(*pairs, strict=True)
        return np.array(power), np.array(size)


@once
def wanderings(residuals: WhitenedResiduals) -> tuple[Wandering, ...]:
    """Zeros that walk, and zeros whose rate walks."""
    return tuple(Wandering.of(residuals, waves(residuals.baseline.setting.rows)) for waves in KINDS)


def log_wandering(residuals: WhitenedResiduals) -> float:
    """ln evidence of courses of all zeros, each its own, against no effect, a mean over kinds of courses."""
    return log_mean([log_mean(log_ratio(residuals, *kind.power_and_size())) for kind in wanderings(residuals)])


def log_beside_wandering(residuals: WhitenedResiduals, trace: Array, sizes: Array) -> tuple[float, float]:
    """ln evidence of courses of all zeros, each its own, and of the same with traces (n, k) of amplitudes N(0, s)
    beside them, ``sizes`` (S,), against no effect, a mean over kinds of courses."""
    together = []
    for kind in wanderings(residuals):
        (power, size), (more_power, more_size) = kind.power_and_size(), kind.beside(residuals.z, trace, sizes)
        values = log_ratio(residuals, power[:, None] + more_power, size[:, None] + more_size)
        together.append(log_mean(values.ravel()))
    return log_wandering(residuals), log_mean(together)


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
    return log_ratio(residuals, *marginal(trace.T @ trace, trace.T @ residuals.z, sizes))


def log_ratio(residuals: WhitenedResiduals, power: Array, size: Array) -> Array:
    """ln B, of any shape, from Q = z'X(X'X + I/g)⁻¹X'z and ln|I + g·X'X|."""
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
