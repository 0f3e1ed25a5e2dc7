"""Sensors whose scatter exceeds the stated noise: is it noise, or a course that runs smoothly along some order?"""

from dataclasses import replace

import numpy as np

from estimator.calibration.noise import with_the_others
from estimator.diagnosis.selection.search_state import LEVEL, SearchState
from estimator.diagnosis.signatures.autocorrelation import autocorrelation
from estimator.diagnosis.signatures.noise import Autocorrelation, ExcessVariance
from estimator.session import Array
from estimator.significance import family_wise, p_value

DOUBTFUL = 0.0
"""ln evidence from which on scatter that is too large is as likely a smooth course as noise, and is said to be both."""


def largest_excess(state: SearchState) -> ExcessVariance | None:
    """The sensor whose residual most exceeds its stated noise; None if none does significantly."""
    m = state.sensor_count
    best = None
    for i, (energy, freedom) in enumerate(zip(*(x.tolist() for x in sensor_scatter(state)), strict=True)):
        if state.baseline.unstated[i] or i in state.scatter_attributed or freedom < 2 or energy <= freedom:
            continue
        p_family = family_wise(float(p_value(energy, freedom)), m * state.families)
        gained = 0.5 * (energy - freedom - freedom * np.log(energy / freedom))
        log_evidence = float(gained - 0.5 * np.log(freedom / 2) - np.log(m))
        if p_family < LEVEL and (best is None or log_evidence > best.log_evidence):
            best = ExcessVariance(i, energy / freedom, freedom, log_evidence, p_family)
    return best


def sensor_scatter(state: SearchState) -> tuple[Array, Array]:
    """(m,) energy, dimensionless, and (m,) degrees of freedom of every sensor's residual readings."""
    residuals = state.residuals
    of_sensor = residuals.sensor_of_row[: residuals.rows] == np.arange(state.sensor_count)[:, None]
    freedom = residuals.row_freedom - (state.attributed()[: residuals.rows] ** 2).sum(axis=1)
    return of_sensor @ state.remaining[: residuals.rows] ** 2, of_sensor @ freedom


def overdispersed(state: SearchState) -> list[bool]:
    """Whether each sensor's residual is plainly larger than stated or, where nothing is stated, than the others'."""
    ratio = state.baseline.expected_ratio
    excess = {e.sensor for e in state.excess}
    if ratio is None:
        return [i in excess for i in range(state.sensor_count)]
    energy, freedom = sensor_scatter(state)
    alike = with_the_others(energy, freedom, ratio)[1] > freedom
    return [i in excess or bool(ratio[i] > 0 and not alike[i]) for i in range(len(ratio))]


def with_unknown_noise(state: SearchState, sensor: int) -> SearchState:
    """The search with the noise of one sensor taken as not stated."""
    unstated = state.baseline.unstated.copy()
    unstated[sensor] = True
    residuals = replace(state.residuals, baseline=replace(state.baseline, unstated=unstated))
    return replace(state, residuals=residuals)


def excess_as_course(state: SearchState, noisy: ExcessVariance) -> Autocorrelation | None:
    """A sensor's scatter, larger than stated, as a course along some order of its rows; None where it is too short."""
    course = autocorrelation(state.residuals, state.attributed(), noisy.sensor, known=False)
    return None if course is None else replace(course, ratio=noisy.ratio, excess_log_evidence=noisy.log_evidence)


def noise_or_course(
    noisy: ExcessVariance, course: Autocorrelation | None
) -> tuple[ExcessVariance | Autocorrelation, ...]:
    """Scatter larger than stated: noise, a smooth course, or noise that may as well be a course."""
    if course is None or course.log_evidence <= DOUBTFUL:
        return (noisy,)
    return (course,) if course.plain else (noisy, replace(course, ratio=1.0))


def with_autocorrelation(state: SearchState) -> SearchState:
    """The search with the sensors added whose residual is not white after everything found."""
    unstated, attributed = state.baseline.unstated, state.attributed()
    each = [
        autocorrelation(state.residuals, attributed, i, known=not unstated[i])
        for i in range(state.sensor_count)
        if i not in state.scatter_attributed
    ]
    significant = [a for a in each if a is not None and a.p_value * state.sensor_count < LEVEL]
    return replace(state, autocorrelated=(*state.autocorrelated, *significant))
