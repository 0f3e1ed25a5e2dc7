"""Detection limits: what this session would have found, and what it cannot see.

A term is named where its ln posterior odds exceed zero. One that explains χ² with q amplitudes has, at the size that
suits it best,

    ln odds = ln prior + ½χ² − ½q ln(1 + χ²)

where the prior odds are of the cause at one place, in one shape and of one size. The limit of an amplitude is that at
which this is positive with 95 % power: χ² is of q degrees of freedom, its noncentrality the amplitude's X'AX. What
would need a size beyond any possible one is absorbed by the calibration.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import optimize
from scipy.special import chndtr

from estimator.causes.contract import Cause, RecordCorrection, Signature
from estimator.diagnosis.posterior.common_causes import CommonCauses
from estimator.diagnosis.posterior.explained import ExplainedSession
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.priors import NOISE_RATIOS, NOISY, SIZES
from estimator.diagnosis.posterior.sensor_causes import SensorCauses
from estimator.diagnosis.posterior.term import Since
from estimator.diagnosis.results import Limit
from estimator.message import joined, say
from estimator.session import Array
from estimator.significance import critical_chi2

POWER = 0.95
"""Share of sessions in which an effect at its limit is found: the usual power of a detection limit (ISO 11843)."""

STRONGEST = 1e5
"""χ² beyond which no threshold lies: prior odds of e⁻⁴⁹⁹⁰⁰."""


@lru_cache(maxsize=4096)
def required(q: int, threshold: float) -> float:
    """Strength, standard errors, of which χ² of q amplitudes exceeds a threshold with `POWER`."""

    def shortfall(strength: float) -> float:
        return 1.0 - float(chndtr(threshold, q, strength**2)) - POWER

    return float(optimize.brentq(shortfall, 1e-3, 200.0))


@lru_cache(maxsize=4096)
def named_from(q: int, log_prior: float) -> float:
    """χ² of q amplitudes from which on a term of such prior odds is named."""

    def log_odds(chi2: float) -> float:
        return log_prior + 0.5 * chi2 - 0.5 * q * float(np.log1p(chi2))

    return float(optimize.brentq(log_odds, max(q - 1.0, 0.0), STRONGEST))


@dataclass(frozen=True, eq=False)
class SeenShapes:
    """Shapes of a cause at one place, as a session sees them. S shapes, q amplitudes."""

    cause: str
    norm: Array
    """(S, q) standard errors per unit of size."""
    scale: Array
    """(S, q) amplitude, SI, at the first row, of a unit of size."""
    largest: float
    """Units of size that are possible."""
    log_prior: float
    """ln prior odds of one shape at one size."""

    def worst(self) -> Array:
        """(q,) the largest amplitude, SI, that a shape needs to be named; NaN where every shape needs an impossible
        one."""
        q = self.norm.shape[1]
        need = required(q, named_from(q, self.log_prior)) / np.maximum(self.norm, 1e-300)
        amplitude = np.where(need < self.largest, np.minimum(need, self.largest) * self.scale, -np.inf).max(axis=0)
        return np.where(np.isfinite(amplitude), amplitude, np.nan)


def limits(state: ExplainedSession) -> tuple[Limit, ...]:
    """One limit a cause of the catalogue."""
    worst: dict[str, list[Array]] = {}
    for seen in seen_shapes(state):
        worst.setdefault(seen.cause, []).append(seen.worst())
    return tuple(limit(state, c, worst.get(c.identifier)) for c in state.catalogue)


def seen_shapes(state: ExplainedSession) -> Iterator[SeenShapes]:
    """The shapes of all causes, as if nothing else acted; such as lasted since before a history where there is one."""
    residuals, setting = state.residuals, state.baseline.setting
    catalogue = [c for c in state.catalogue if isinstance(c, Signature)]
    info, _ = InputInformation.of(residuals)
    single, common = state.of_causes or (SensorCauses(residuals, catalogue), CommonCauses(residuals, catalogue))
    for block in single.blocks:
        A = info.A[np.ix_(block.index, block.index)]
        for part in block.parts:
            if part.since is not Since.OPEN:
                square = ((A @ part.rows) * part.rows).sum(axis=1)
                left = np.array([part.cause.left(setting, s) for s in part.nonlinear])
                largest, prior = float(block.sizes[-1]), part.log_prior - float(np.log(len(SIZES)))
                scale = part.scale * left[:, None]
                yield SeenShapes(part.cause.identifier, np.sqrt(np.maximum(square, 0.0)), scale, largest, prior)
    for columns in common.blocks:
        assert columns.effect is not None
        square = ((info.A @ columns.W) * columns.W).sum(axis=0)[None]
        prior = columns.log_prior - float(np.log(len(SIZES)))
        scale = columns.effect.scale[None]
        yield SeenShapes(columns.place[0], np.sqrt(np.maximum(square, 0.0)), scale, float(SIZES[-1]), prior)


def limit(state: ExplainedSession, cause: Cause, worst: Sequence[Array] | None) -> Limit:
    """The limit of one cause, from the worst amplitudes at every place; None where the session lacks what it needs."""
    if isinstance(cause, RecordCorrection):
        lacking = missing(state, cause)
        return Limit(
            cause.identifier,
            None if lacking else (),
            (),
            lacking and say("the session lacks {missing}", missing=lacking),
        )
    if not isinstance(cause, Signature):
        return excess_limit(state, cause)
    if worst is None:
        lacking = missing(state, cause) or cause.lacking
        return Limit(cause.identifier, None, cause.units, say("the session lacks {missing}", missing=lacking))
    seen = np.stack(worst)
    if np.isnan(seen).all():
        return Limit(cause.identifier, None, cause.units, "the calibration absorbs it completely")
    amplitude = np.where(np.isnan(seen), -np.inf, seen).max(axis=0)
    return Limit(cause.identifier, tuple(amplitude[np.isfinite(amplitude)].tolist()), cause.units, "")


def missing(state: ExplainedSession, cause: Cause) -> str:
    """Names the needs of a cause that the session does not meet."""
    lacking = sorted(n for n in cause.needs if not state.baseline.setting.has(n))
    if state.residuals.change is None and "history" in cause.needs:
        lacking.append("history")
    return joined(", ", lacking)


def excess_limit(state: ExplainedSession, cause: Cause) -> Limit:
    """Extra standard deviation of one reading that would be called excess noise, at the quietest sensor's noise.

    With ν degrees of freedom a variance of r times the stated one gains ½ν(r − 1 − ln r).
    """
    m = state.sensor_count
    if state.baseline.unstated.all():
        return Limit(cause.identifier, None, cause.units, "the file states no noise to exceed")
    freedom = max(state.residuals.freedom / m, 2.0)
    needed = float(np.log(m * len(NOISE_RATIOS) / NOISY))
    seen = optimize.brentq(lambda r: 0.5 * freedom * (r - 1 - np.log(r)) - needed, 1.0, STRONGEST)
    ratio = freedom * seen / critical_chi2(POWER, freedom)
    sigma = float(np.sqrt(np.median(state.baseline.variance)))
    return Limit(cause.identifier, (sigma * float(np.sqrt(max(ratio - 1, 0.0))),), cause.units, "")
