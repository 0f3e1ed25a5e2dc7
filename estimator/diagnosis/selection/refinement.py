"""Between the points of the grid: the best nonlinear parameters, and their error in the amplitudes' sigma."""

from dataclasses import replace

import numpy as np

from estimator.causes import Setting, Shape
from estimator.diagnosis.selection.search_state import Found, Search
from estimator.diagnosis.signatures.lasting import before
from estimator.diagnosis.signatures.scores import Scored, rescored
from estimator.session import Array


def polished(state: Search) -> Search:
    """Every finding with a continuous nonlinear parameter moved to its best value, the parameter left free there."""
    for found in state.found:
        best = refined(state, found)
        if best is not found.best:
            new = replace(found, best=best)
            state = replace(state, found=tuple(new if f is found else f for f in state.found))
    return state


def refined(state: Search, found: Found) -> Scored:
    """The best shape near the one found, bent columns appended; the same where nothing is continuous."""
    setting, cause, own = state.baseline.setting, found.best.cause, len(found.best.cause.units)
    near = list(cause.polished(setting, found.best.shape.first(own)))
    if not near:
        return found.best
    evidence, lasting = state.evidence, found.best.lasting
    taken, rest = state.taken(without=found), found.best.columns[:, own:]
    padding = found.best.shape.columns[..., own:]

    def bend(where: Setting, shape: Shape) -> Array:
        return cause.bend(where, replace(shape, columns=cause.columns(where, shape)))

    def scored(shape: Shape) -> Scored:
        trace = evidence.trace(shape.columns, before(evidence, cause, [shape]) if lasting else 0.0)
        padded = replace(shape, columns=np.concatenate([shape.columns, padding], axis=-1))
        new = replace(found.best, shape=padded, columns=np.concatenate([trace, rest], axis=1))
        return rescored(evidence, new, taken)

    best = max(map(scored, near), key=lambda s: s.statistic)
    bent = bend(setting, best.shape)
    trace = evidence.trace(bent, before(evidence, cause, [best.shape], bend) if lasting else 0.0)
    shape = replace(best.shape, columns=np.concatenate([best.shape.columns, bent], axis=-1))
    return replace(best, shape=shape, columns=np.concatenate([best.columns, trace], axis=1))
