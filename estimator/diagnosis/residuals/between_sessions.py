"""Changes since the history: the parameters of earlier sessions as one reference with covariance.

Earlier baselines come turned into the frame of now (`turns`), so that what is compared is small however the block sat.
The turn k that was taken off is put back as what it is, an amplitude: with the parameters' response T to a turn the
change is d = (now − turned history) + T·k, linear about the exact rotation. In arbitrary orientations the applied
vectors are estimated, so a common turn of all axes cannot be observed: only what is orthogonal to one is compared.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.arrays import eigh
from estimator.causes.fixture import turned
from estimator.diagnosis.residuals.baseline import Baseline, observable_directions, turn_response
from estimator.diagnosis.residuals.refitted import fitted_about
from estimator.diagnosis.residuals.whitened import (
    EarlierSession,
    ParameterChange,
    WhitenedResiduals,
)
from estimator.parameters import SensorParameters
from estimator.session import Array

NO_VARIANCE = 1e-13
"""Variance over the largest (each parameter in its own sigma) below which a direction has none: rounding of a
correlation matrix of some hundred parameters."""


def deviation(now: SensorParameters, earlier: SensorParameters, norm: Array) -> Array:
    """(m, 5) dimensionless, leading axes free: ``earlier`` parameters from those of ``now``; ``norm`` (m,) of the
    applied vector, m/s²."""
    step = np.empty((*earlier.scale.shape, 5))
    step[..., 0] = np.log(earlier.scale / now.scale)
    step[..., 1] = (earlier.bias - now.bias) / norm
    step[..., 2] = (earlier.quadratic - now.quadratic) * norm
    step[..., 3:] = (np.swapaxes(now.axis_tangents, -1, -2) @ (earlier.axis - now.axis)[..., None])[..., 0]
    return step


def carried(now: SensorParameters, frames: Array) -> Array:
    """(P, P) dimensionless: a change along tangents ``frames`` (m, 3, 2) as one along the tangents of ``now``."""
    m = len(frames)
    full, index = np.zeros((m, 5, m, 5)), np.arange(m)
    full[index, :, index, :] = carried_each(now, frames)
    return full.reshape(5 * m, 5 * m)


def carried_each(now: SensorParameters, frames: Array) -> Array:
    """(m, 5, 5) dimensionless, leading axes free: the same of every sensor, whose parameters stay its own."""
    blocks = np.broadcast_to(np.eye(5), (*frames.shape[:-2], 5, 5)).copy()
    blocks[..., 3:, 3:] = np.swapaxes(now.axis_tangents, -1, -2) @ frames
    return blocks


def inverse_root(matrix: Array) -> Array:
    """W (…, P, P), symmetric up to scale, with W'W the pseudo-inverse of a dimensionless covariance (…, P, P)."""
    scale = np.sqrt(np.diagonal(matrix, axis1=-2, axis2=-1))
    values, vectors = eigh(matrix / scale[..., :, None] / scale[..., None, :])
    positive = values > NO_VARIANCE * values[..., -1:]
    inverse = np.where(positive, 1 / np.sqrt(np.where(positive, values, 1.0)), 0.0)
    return np.asarray((vectors * inverse[..., None, :]) @ np.swapaxes(vectors, -1, -2) / scale[..., None, :])


def parameter_change(now: Baseline, history: Sequence[Baseline]) -> ParameterChange | None:
    """The whitened change of all parameters since the history, in the frame of now; None without a usable history.

    The reference is the information-weighted mean of the history's parameters. What does not depend on the common turn
    because the block sat otherwise enters without it.
    """
    p, observable = now.parameters, observable_directions(now.gauge_free, now.parameters)
    alike = [h for h in history if h.setting.kinds == now.setting.kinds]
    if not alike:
        return None
    steps = [deviation(p, h.parameters, now.setting.norm).reshape(-1) for h in alike]
    maps = [carried(p, h.parameters.axis_tangents) for h in alike]
    known = [observable.T @ map @ h.covariance_between @ map.T @ observable for h, map in zip(alike, maps, strict=True)]
    information = [(root := inverse_root(covariance)).T @ root for covariance in known]
    turn = observable.T @ turn_response(p)
    information = [
        without_directions(i, turn) if h.sits_otherwise else i for h, i in zip(alike, information, strict=True)
    ]
    covariance = (root := inverse_root(np.sum(information, axis=0))).T @ root
    shares = [observable @ covariance @ part @ observable.T for part in information]
    whiten = observable @ inverse_root(covariance + observable.T @ now.covariance_between @ observable) @ observable.T
    steps = [step + map @ effect_left_out(h) for h, step, map in zip(alike, steps, maps, strict=True)]
    step = np.sum([share @ step for share, step in zip(shares, steps, strict=True)], axis=0)
    earlier = tuple(
        EarlierSession(WhitenedResiduals.of(h), share @ map, replace(h.setting, parameters=p))
        for h, share, map in zip(alike, shares, maps, strict=True)
    )
    return ParameterChange(whiten @ (effect_left_out(now) - step), whiten, earlier)


def effect_left_out(baseline: Baseline) -> Array:
    """(P,) dimensionless: what the turns and the course that a baseline is linear about would make of its parameters if
    left in."""
    setting = baseline.setting
    if not (setting.turn.any() or setting.flip_turn.any() or baseline.course is not None):
        return np.zeros(5 * len(setting.kinds))
    residuals = WhitenedResiduals.of(baseline)
    columns = setting.through(turned(setting.n)) @ setting.turn + fitted_about(baseline)
    return residuals.response @ residuals.whitened(columns[..., None])[:, 0]


def without_directions(information: Array, directions: Array) -> Array:
    """(q, q) information that leaves nothing known along ``directions`` (q, k), both dimensionless."""
    along = information @ directions
    return np.asarray(information - along @ np.linalg.pinv(directions.T @ along, hermitian=True) @ along.T)
