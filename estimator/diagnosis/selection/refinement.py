"""Between the points of the grid: the best nonlinear parameters, and their error in the amplitudes' sigma."""

from dataclasses import replace

import numpy as np

from estimator.causes.contract import Setting, Shape
from estimator.diagnosis.selection.search_state import Found, SearchState
from estimator.diagnosis.signatures.lasting import absorbed_before
from estimator.diagnosis.signatures.scores import rescored
from estimator.diagnosis.signatures.traces import Scored
from estimator.session import Array


def with_refined_shapes(state: SearchState) -> SearchState:
    """Every finding with a continuous nonlinear parameter moved to its best value, the parameter left free there."""
    for found in state.found:
        best = refined(state, found)
        if best is not found.best:
            new = replace(found, best=best)
            state = replace(state, found=tuple(new if f is found else f for f in state.found))
    return state


def refined(state: SearchState, found: Found) -> Scored:
    """The best shape near the one found, its derivatives appended; the same where nothing is continuous."""
    old, setting = found.best, state.baseline.setting
    cause, own = old.cause, len(old.cause.units)
    near = list(cause.neighbours(setting, old.shape.first(own)))
    if not near:
        return old
    attributed, padding = state.attributed(without=found), old.shape.columns[..., own:]

    def derivative(where: Setting, shape: Shape) -> Array:
        """(R, m, r) m/s² (rad/s)."""
        return cause.derivative(where, replace(shape, columns=cause.columns(where, shape)))

    def scored(shape: Shape) -> Scored:
        before = absorbed_before(state.residuals, cause, [shape]) if old.lasting else 0.0
        trace = np.concatenate([state.residuals.trace(shape.columns, before), old.trace[:, own:]], axis=1)
        padded = replace(shape, columns=np.concatenate([shape.columns, padding], axis=-1))
        return rescored(state.residuals, replace(old, shape=padded, trace=trace), attributed)

    best = max(map(scored, near), key=lambda s: s.statistic)
    bent = derivative(setting, best.shape)
    before = absorbed_before(state.residuals, cause, [best.shape], derivative) if old.lasting else 0.0
    trace = np.concatenate([best.trace, state.residuals.trace(bent, before)], axis=1)
    return replace(
        best, shape=replace(best.shape, columns=np.concatenate([best.shape.columns, bent], axis=-1)), trace=trace
    )
