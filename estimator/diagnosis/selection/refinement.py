"""Refinement between points of the grid: the best nonlinear parameters, and their error in the amplitudes' sigma."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.contract import Setting, Shape
from estimator.diagnosis.selection.search_state import Detection, SearchState
from estimator.diagnosis.signatures.lasting import absorbed_before
from estimator.diagnosis.signatures.scores import rescored
from estimator.diagnosis.signatures.traces import Scored
from estimator.least_squares import FAINT, least_squares
from estimator.session import Array

VAGUE = 2.0
"""Sigmas of its own below which an amplitude is not known, though its signature stands out: the likelihood is then flat
along shape and amplitude together, and neither means anything."""

AS_LIKELY = 5.3
"""ln evidence within which a rival without a free shape takes the place of a cause whose shape is not known: it is
among the causes that are listed anyway."""


def with_refined_shapes(state: SearchState) -> SearchState:
    """Every finding with a continuous nonlinear parameter moved to its best value, the parameter left free there.

    Where the session does not tell the parameter, the likeliest cause that has none is named first instead, and failing
    that the parameter keeps its value of the grid.
    """
    for detection in state.detections:
        if detection.event:
            continue  # moved with all that share its course (`shared_shape.py`)
        best = refined(state, detection)
        if best is detection.best:
            continue
        new = plainer(state, detection) if vague(state, detection, best) else replace(detection, best=best)
        state = replace(state, detections=tuple(new if f is detection else f for f in state.detections))
    return state


def vague(state: SearchState, detection: Detection, best: Scored) -> bool:
    """Whether a refined shape leaves the amplitudes unknown."""
    attributed = state.attributed(without=detection)
    columns = best.trace - attributed @ (attributed.T @ best.trace)
    fit, amplitudes = least_squares(columns, state.residuals.z, FAINT), slice(0, len(best.cause.units))
    return bool(np.all(np.abs(fit.value[amplitudes]) < VAGUE * np.sqrt(np.diagonal(fit.covariance)[amplitudes])))


def plainer(state: SearchState, detection: Detection) -> Detection:
    """The finding as the likeliest rival on its sensors that has no free shape; as it is where none is as likely."""
    for rival, log_evidence in detection.ranking:
        if detection.ranking[0][1] - log_evidence > AS_LIKELY:
            break
        if rival.sensors == detection.best.sensors and not rival.cause.nonlinear_units and not rival.cause.between:
            return replace(detection, best=rescored(state.residuals, rival, state.attributed(without=detection)))
    return detection


def refined(state: SearchState, detection: Detection) -> Scored:
    """The best shape near the one found, its derivatives appended; the same where nothing is continuous."""
    old, setting = detection.best, state.baseline.setting
    cause, width = old.cause, len(old.cause.units)
    near = list(cause.neighbours(setting, old.shape.first(width)))
    if not near:
        return old
    attributed, padding = state.attributed(without=detection), old.shape.columns[..., width:]

    def derivative(where: Setting, shapes: Sequence[Shape]) -> Array:
        """(R, m, r) m/s² (rad/s), of a single shape."""
        (shape,) = shapes
        return cause.derivative(where, replace(shape, columns=cause.columns(where, shape)))

    def scored(shape: Shape) -> Scored:
        before = absorbed_before(state.residuals, cause, [shape]) if old.lasting else 0.0
        trace = np.concatenate([state.residuals.trace(shape.columns, before), old.trace[:, width:]], axis=1)
        padded = replace(shape, columns=np.concatenate([shape.columns, padding], axis=-1))
        return rescored(state.residuals, replace(old, shape=padded, trace=trace), attributed)

    best = max(map(scored, near), key=lambda s: s.statistic)
    bent = derivative(setting, [best.shape])
    before = absorbed_before(state.residuals, cause, [best.shape], derivative) if old.lasting else 0.0
    trace = np.concatenate([best.trace, state.residuals.trace(bent, before)], axis=1)
    return replace(
        best, shape=replace(best.shape, columns=np.concatenate([best.shape.columns, bent], axis=-1)), trace=trace
    )
