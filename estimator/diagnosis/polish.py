"""Between the points of the grid: the best nonlinear parameters, and their error in the amplitudes' sigma."""

from dataclasses import replace

import numpy as np

from estimator.causes import Shape
from estimator.diagnosis.candidates import Scored, rescored
from estimator.diagnosis.state import Found, Search


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
    plain = Shape(found.best.shape.sensors, found.best.shape.columns[..., :own], found.best.shape.nonlinear)
    near = list(cause.polished(setting, plain))
    if not near:
        return found.best
    taken, rest = state.taken(without=found), found.best.columns[:, own:]
    padding = found.best.shape.columns[..., own:]

    def scored(shape: Shape) -> Scored:
        trace = np.concatenate([state.evidence.trace(shape.columns, lasting=found.best.lasting), rest], axis=1)
        padded = Shape(shape.sensors, np.concatenate([shape.columns, padding], axis=-1), shape.nonlinear)
        return rescored(state.evidence, replace(found.best, shape=padded, columns=trace), taken)

    best = max(map(scored, near), key=lambda s: s.statistic)
    bent = cause.bend(setting, Shape(best.shape.sensors, best.shape.columns[..., :own], best.shape.nonlinear))
    columns = np.concatenate([best.shape.columns, bent], axis=-1)
    trace = np.concatenate([best.columns, state.evidence.trace(bent, lasting=best.lasting)], axis=1)
    return replace(best, shape=Shape(best.shape.sensors, columns, best.shape.nonlinear), columns=trace)
