"""A baseline whose noise or nuisances were changed, its parameters fitted anew beside them."""

from dataclasses import replace

from estimator.diagnosis.residuals.baseline import Baseline, block_columns, observable_directions
from estimator.diagnosis.residuals.flipped_run import flip_effect
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.parameters import PLAUSIBLE
from estimator.session import Array


def fitted_about(baseline: Baseline) -> Array:
    """(R, m) m/s² (rad/s): the effects that a fit is linear about; they are in its residuals."""
    known = flip_effect(baseline.setting)
    return known if baseline.course is None else known + baseline.course


def refitted(baseline: Baseline) -> Baseline:
    """The baseline with its parameters at their least squares under its own noise and nuisances: one linear step.

    The step holds no common turn of all axes where none can be observed: it would be rounding over nothing, and would
    turn the session away from its history. Where the readings tell next to nothing the plausible range holds it: with
    s the least squares and F their information, (F + R)⁻¹ F s = s − (F + R)⁻¹ R s, R of that range; a step of half the
    scale is no linear one. The turn of the flipped run and the course that the fit is linear about stay in the
    residuals, as the effects that they are.
    """
    residuals, setting = WhitenedResiduals.of(baseline), baseline.setting
    observable = observable_directions(baseline.gauge_free, baseline.parameters)
    whitened = residuals.whitened((baseline.residual - fitted_about(baseline))[..., None])[:, 0]
    free = observable @ (observable.T @ (residuals.response @ whitened))
    step = free - baseline.covariance @ free / PLAUSIBLE**2
    remaining = baseline.residual - block_columns(baseline.design) @ step
    parameters = setting.parameters.stepped(step.reshape(-1, 5), setting.norm)
    return replace(baseline, residual=remaining, setting=replace(setting, parameters=parameters))
