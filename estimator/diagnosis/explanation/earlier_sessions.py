"""What naming the causes is worth on another session: amplitudes found here, held against what was left there.

The latest earlier session keeps its own parameters, fitted anew with and without; the effect with its amplitude and
covariance V comes from this session alone. What the baseline there leaves, z, is of unit covariance without the
effect, and with it of mean X·a and covariance 1 + X V X' (X the trace of the signature there).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.diagnosis.explanation.extended_model import Amplitudes
from estimator.diagnosis.explanation.rivals import matching
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.whitened import Evidence
from estimator.diagnosis.results import Score, Transfer
from estimator.diagnosis.selection.search_state import Search
from estimator.diagnosis.signatures.scores import Scored
from estimator.session import Array

CLEAR = 3.0
"""ln evidence by which the earlier session says that it had an effect, or had not."""

LN_2PI = float(np.log(2 * np.pi))


@dataclass(frozen=True, eq=False)
class Carried:
    """Findings as they would show in another session. f amplitudes."""

    columns: Array
    """(R, m, f)"""
    value: Array
    """(f,)"""
    covariance: Array
    """(f, f)"""
    places: Array
    """(f,) which of all fitted amplitudes these are."""


def transfer(state: Search, fitted: Amplitudes, new: Sequence[bool | None]) -> Transfer | None:
    """Scores of the latest earlier session before and after; None where no finding can have acted there.

    ``new``: `newness` of every finding.
    """
    if not state.history:
        return None
    earlier = state.history[-1]
    carried = carried_to(earlier, state, fitted, new)
    if carried is None:
        return None
    evidence = Evidence.of(earlier)
    before, after = agreement(evidence, nothing_of(carried)), agreement(evidence, carried)
    return Transfer(earlier.session.started_at, before, after)


def carried_to(earlier: Baseline, state: Search, fitted: Amplitudes, new: Sequence[bool | None]) -> Carried | None:
    """The findings that an earlier session had too, together."""
    parts = [
        part
        for k, found in enumerate(state.found)
        if not new[k] and (part := alone(earlier, found.best, fitted, k)) is not None
    ]
    if not parts:
        return None
    places = np.concatenate([p.places for p in parts])
    columns = np.concatenate([p.columns for p in parts], axis=-1)
    return Carried(columns, fitted.value[places], fitted.covariance[np.ix_(places, places)], places)


def alone(earlier: Baseline, scored: Scored, fitted: Amplitudes, k: int) -> Carried | None:
    """One finding in an earlier session; None where it acts in one session only or cannot show in that one."""
    if not scored.cause.can_be_modelled:
        return None
    columns = matching(earlier, scored)
    if columns is None:
        return None
    places = fitted.slices[k].start + np.arange(len(scored.cause.units))
    covariance = fitted.covariance[np.ix_(places, places)]
    return Carried(columns[..., : len(places)], fitted.value[places], covariance, places)


def newness(state: Search, fitted: Amplitudes) -> tuple[bool | None, ...]:
    """Whether each finding came since the latest earlier session; None without history or for what moved since.

    The readings of that session say it: with the effect or without. Where they are of two minds, it is how the
    parameters moved.
    """
    if not state.history:
        return (None,) * len(state.found)
    earlier, evidence = state.history[-1], Evidence.of(state.history[-1])
    return tuple(
        None if f.best.cause.between else is_new(f.best, evidence, alone(earlier, f.best, fitted, k))
        for k, f in enumerate(state.found)
    )


def is_new(scored: Scored, evidence: Evidence, carried: Carried | None) -> bool:
    """Whether one finding came since the session that ``evidence`` is of; ``carried`` as it would show there."""
    if carried is not None:
        gained = agreement(evidence, carried).log_score - agreement(evidence, nothing_of(carried)).log_score
        if abs(gained) * evidence.freedom > CLEAR:
            return gained < 0
    return not scored.lasting


def nothing_of(carried: Carried) -> Carried:
    """The same with no effect."""
    return replace(carried, value=0 * carried.value, covariance=0 * carried.covariance)


def agreement(evidence: Evidence, carried: Carried) -> Score:
    """How well the readings of a session agree with a carried effect."""
    trace = evidence.trace(carried.columns)
    left = evidence.z - trace @ carried.value
    inner = np.eye(trace.shape[1]) + carried.covariance @ (trace.T @ trace)
    along = trace.T @ left
    square = float(left @ left - along @ np.linalg.solve(inner, carried.covariance @ along))
    volume = float(np.linalg.slogdet(inner)[1])
    R, m = evidence.baseline.residual.shape
    errors = left[: R * m].reshape(R, m) / evidence.whiten.weight
    return Score(
        rms=float(np.sqrt(np.mean(errors**2))),
        chi2_per_dof=square / evidence.freedom,
        log_score=-0.5 * (square + volume) / evidence.freedom - 0.5 * LN_2PI,
    )
