"""Detection limits: what this session would have found, and what it cannot see.

A signature of q amplitudes whose trace has norm s per unit amplitude is found with 95 % power at the family-wise
level when amplitude·s reaches the root of the noncentrality at which χ²_q exceeds the threshold with that power.
"""

from functools import lru_cache

import numpy as np
from scipy import optimize
from scipy.special import chndtr

from estimator.causes.contract import Cause, RecordCorrection, Signature
from estimator.diagnosis.results import Limit
from estimator.diagnosis.selection.search_state import LEVEL, NAMED, SearchState
from estimator.diagnosis.signatures.traces import INVISIBLE, Traces
from estimator.message import joined, say
from estimator.significance import critical_chi2

POWER = 0.95
"""Share of sessions in which an effect at its limit is found: the usual power of a detection limit (ISO 11843)."""


@lru_cache(maxsize=4096)
def required(q: int, p_single: float) -> float:
    """Strength, standard errors, that a test of q amplitudes at level ``p_single`` finds with `POWER`."""
    threshold = critical_chi2(p_single, q)

    def shortfall(strength: float) -> float:
        return 1.0 - float(chndtr(threshold, q, strength**2)) - POWER

    return float(optimize.brentq(shortfall, 1e-3, 200.0))


def limits(state: SearchState) -> tuple[Limit, ...]:
    """One limit a cause of the catalogue."""
    traces = {t.cause.identifier: t for t in state.traces}
    return tuple(limit(state, c, traces.get(c.identifier)) for c in state.catalogue)


def limit(state: SearchState, cause: Cause, traces: Traces | None) -> Limit:
    """The limit of one cause; ``traces`` None where the session lacks what the cause needs."""
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
    if traces is None:
        lacking = missing(state, cause) or cause.lacking
        return Limit(cause.identifier, None, cause.units, say("the session lacks {missing}", missing=lacking))
    norms = np.linalg.norm(traces.columns, axis=1)
    raw = traces.raw[:, : norms.shape[1]]
    visible = (norms > INVISIBLE * raw) & (raw > 0)
    places = int(visible.any(axis=1).sum())
    if places == 0:
        return Limit(cause.identifier, None, cause.units, "the calibration absorbs it completely")
    need = required(1, NAMED / (places * state.families))
    norms = norms / np.array([cause.left(state.baseline.setting, shape) for shape in traces.shapes])[:, None]
    worst = [float(need / n[v].min()) if v.any() else float("nan") for n, v in zip(norms.T, visible.T, strict=True)]
    return Limit(cause.identifier, tuple(w for w in worst if np.isfinite(w)), cause.units, "")


def missing(state: SearchState, cause: Cause) -> str:
    """Names the needs of a cause that the session does not meet."""
    lacking = sorted(n for n in cause.needs if not state.baseline.setting.has(n))
    if state.residuals.change is None and "history" in cause.needs:
        lacking.append("history")
    return joined(", ", lacking)


def excess_limit(state: SearchState, cause: Cause) -> Limit:
    """Extra standard deviation of one reading that would be called excess noise, at the quietest sensor's noise."""
    m = state.sensor_count
    if state.baseline.unstated.all():
        return Limit(cause.identifier, None, cause.units, "the file states no noise to exceed")
    freedom = max(state.residuals.freedom / m, 2.0)
    threshold = critical_chi2(LEVEL / (m * state.families), freedom)
    ratio = threshold / critical_chi2(POWER, freedom)
    sigma = float(np.sqrt(np.median(state.baseline.variance)))
    return Limit(cause.identifier, (sigma * float(np.sqrt(max(ratio - 1, 0.0))),), cause.units, "")
