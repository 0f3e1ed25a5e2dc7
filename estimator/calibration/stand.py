"""Calibration on a two-axis stand: closed form → maximum likelihood → what is observable → result.

`calibrate_stand` takes sessions of one schedule together, so that a fleet is one vectorised call.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.applied_vector import Geometry, stand_geometry
from estimator.calibration import noise
from estimator.calibration.analytic import answers, closed_form, linear_start
from estimator.calibration.observability import Spectrum, spectrum
from estimator.calibration.refine import RefinedFit, fit, input_variance
from estimator.calibration.stand_report import Reports, Solved
from estimator.forward import measured, projected
from estimator.parameters import SensorParameters, nominal
from estimator.session import Array, CalibrationSession
from estimator.significance import p_value


def calibrate_stand(sessions: Sequence[CalibrationSession]) -> Reports:
    """Calibrations of averaged two-axis-stand sessions that share one schedule.

    Parameters
    ----------
    sessions : the same stand settings, rows, mounting and sensors in each (`estimator.calibration.batch` groups them).

    Returns
    -------
    One `Calibration` a session, in order, each built when it is read.
    """
    return Reports(tuple(sessions), solved(sessions))


def solved(sessions: Sequence[CalibrationSession], start: SensorParameters | None = None) -> Solved:
    """The solution of sessions that share one schedule, as arrays over the sessions.

    ``start`` (S, m): where to begin, and where what the rows do not determine stays; by default the closed form.
    """
    first = sessions[0]
    geometry = stand_geometry(first)
    readings, errors = zip(*map(measured, sessions), strict=True)
    y = np.stack(readings)
    start = starting_point(y, first, geometry) if start is None else start
    variance, unstated = noise_variance(y, np.stack(errors), start, first, geometry)
    solution, stated = fit(y, variance, geometry, start), np.all(~unstated, axis=(1, 2))
    seen, p_value, factor = judged(solution, stated)
    solved = Solved(y, geometry, solution, seen, stated, p_value, factor, np.full((len(y), 5 * y.shape[2]), np.inf))
    return replace(solved, freedom=freedom(solved, unstated))


def freedom(solved: Solved, unstated: Array) -> Array:
    """(S, 5 m) degrees of freedom of the variances: of estimated noise, or of the factor that stated noise grew by.

    unstated : (S, R, m) bool, readings whose noise was estimated.
    """
    fitted, known = solved.fitted, solved.freedom
    unstated = unstated & np.isfinite(fitted.variance)
    if unstated.any():
        known = noise.freedom_of(fitted.variance, solved.y, fitted.parameters, solved.geometry, unstated)
    if not (solved.factor > 1.0).any():
        return known
    grown, dof = solved.factor[:, None], np.maximum(fitted.readings - solved.spectrum.rank, 1)[:, None]
    steady, whole = (np.diagonal(c, axis1=1, axis2=2) for c in (fitted.repeatability, fitted.covariance))
    share = 1.0 + (whole - steady) / (grown * steady)
    return np.where(grown > 1.0, dof * share**2, known)


def starting_point(y: Array, session: CalibrationSession, geometry: Geometry) -> SensorParameters:
    """The closed form, or where the rows do not determine it a linear fit about the nominal values: (S, m).

    y : (S, R, m) readings, offset taken off, reading units.
    """
    base = nominal(session.sensors)
    start = closed_form(y, session, base, geometry.norm)
    return linear_start(y, geometry.n, geometry.norm, base) if start is None else start


def noise_variance(
    y: Array, errors: Array, start: SensorParameters, session: CalibrationSession, geometry: Geometry
) -> tuple[Array, Array]:
    """Variance of the independent noise at the input (S, R, m), (m/s²)² or (rad/s)², and where none is stated.

    y, errors : (S, R, m) readings, offset taken off, and their standard errors, reading units. Where none is stated
    the variance is estimated; where, (S, R, m) bool, is returned too.
    The block's tilt in a row, which the stand's setting does not know, counts as noise of each sensor.
    A sensor whose reading is constant answers to nothing: its noise is infinite, so that it takes no part.
    """
    variance = input_variance(start, errors, np.array([s.bias_repeatability for s in session.sensors]))
    if session.tilt_error is not None:
        across = geometry.norm**2 - projected(start.axis, geometry.n) ** 2
        variance = variance + np.maximum(across, 0.0) * session.tilt_error[:, None] ** 2
    unstated = np.isnan(variance)
    variance = np.where(answers(y)[:, None, :], variance, np.inf)
    if np.isnan(variance).any():
        variance = noise.with_estimated(variance, y, start, geometry)
    return variance, unstated


def judged(solution: RefinedFit, stated: Array) -> tuple[Spectrum, Array, Array]:
    """The observable part, the p-value (S,), and the factor (S,) by which stated row noise must grow to be believed.

    stated : (S,) bool, whether all noise is; the others are numbers without unit.
    Where the stated noise cannot explain the residuals, all that is drawn anew at every row is enlarged by χ² per
    degree of freedom; the estimate stays, and so do the stand's constant errors.
    """
    seen = spectrum(solution.information)
    dof = solution.readings - seen.rank
    chance = p_value(solution.chi2, dof)
    doubtful = stated & (chance < noise.SUSPICIOUS) & (solution.chi2 > dof)
    factor = np.where(doubtful, solution.chi2 / np.maximum(dof, 1), 1.0)
    if not doubtful.any():
        return seen, chance, factor
    return spectrum(solution.information / factor[:, None, None, None]), chance, factor
