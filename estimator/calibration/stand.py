"""Calibration on a two-axis stand: closed form → maximum likelihood → what is observable → result.

`calibrate_stand` takes sessions of one schedule together, so that a fleet is one vectorised call.
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import tangents
from estimator.calibration import noise, observability
from estimator.calibration.analytic import closed_form, linear_start
from estimator.calibration.refine import Fitted, fit, input_variance
from estimator.forward import measured, projected, slope
from estimator.parameters import SensorParameters, names, nominal, units
from estimator.reference import Geometry, stand_geometry
from estimator.results import Calibration, Estimate, Fit, KnownCombination, Residuals, SensorCalibration
from estimator.session import Array, CalibrationSession

METHOD = "two-axis-stand/maximum-likelihood"


def calibrate_stand(sessions: Sequence[CalibrationSession]) -> list[Calibration]:
    """Calibrations of averaged two-axis-stand sessions that share one schedule.

    Parameters
    ----------
    sessions : the same stand settings, rows, mounting and sensors in each (`estimator.calibration.batch` groups them).

    Returns
    -------
    One `Calibration` a session, in order.
    """
    first = sessions[0]
    geometry = stand_geometry(first)
    readings, errors = zip(*map(measured, sessions), strict=True)
    y, se = np.stack(readings), np.stack(errors)
    start = closed_form(y, first)
    if start is None:
        start = linear_start(y, geometry.n, nominal(first.sensors))
    repeatability = np.array([s.bias_repeatability for s in first.sensors])
    variance = input_variance(start, se, repeatability)
    unstated = np.isnan(variance)
    if unstated.any():
        variance = np.where(unstated, noise.estimated_variance(y, start, geometry), variance)
    solution, factor = honest(y, variance, geometry, start, stated=~unstated.any(axis=(1, 2)))
    seen = observability.observed(solution.information)
    return [_result(k, s, geometry, solution, y, seen, factor, unstated) for k, s in enumerate(sessions)]


def honest(
    y: Array, variance: Array, geometry: Geometry, start: SensorParameters, stated: Array
) -> tuple[Fitted, Array]:
    """Fit; where stated noise cannot explain the residuals, enlarge it by χ² per degree of freedom and fit again.

    Returns the fit and the factor (S,) by which the variance was enlarged. χ² stays that of the stated noise.
    """
    solution = fit(y, variance, geometry, start)
    dof = degrees_of_freedom(solution)
    factor = np.ones(len(y))
    for k in np.flatnonzero(stated & (solution.chi2 > dof)):
        if noise.p_value(solution.chi2[k], int(dof[k])) < noise.SUSPICIOUS:
            factor[k] = solution.chi2[k] / max(dof[k], 1)
    if np.all(factor == 1.0):
        return solution, factor
    enlarged = fit(y, variance * factor[:, None, None], geometry, solution.parameters)
    return enlarged.with_chi2(solution.chi2), factor


def degrees_of_freedom(solution: Fitted) -> Array:
    """(S,) readings minus what they determine."""
    _, R, m = solution.residual.shape
    return R * m - rank(solution.information)


def rank(information: Array) -> Array:
    """(S,) number of parameter directions that the readings determine, from (S, m, 5, 5)."""
    return (np.linalg.eigvalsh(information) > observability.LIMIT**-2).sum(axis=(-1, -2))


def _result(
    k: int,
    session: CalibrationSession,
    geometry: Geometry,
    solution: Fitted,
    y: Array,
    seen: Array,
    factor: Array,
    unstated: Array,
) -> Calibration:
    """The calibration of session k of the batch."""
    p = solution.parameters
    own = SensorParameters(p.scale[k], p.bias[k], p.quadratic[k], p.axis[k])
    flat = own.si_factors(geometry.norm)
    masked = np.where(seen[k].reshape(-1), flat, np.nan)
    covariance = solution.covariance[k] * masked[:, None] * masked
    repeatability = solution.repeatability[k] * masked[:, None] * masked
    known = _known(k, session, geometry, solution, y, seen[k])
    sigma = np.sqrt(np.diagonal(covariance)).reshape(-1, 5)
    steady = np.sqrt(np.diagonal(repeatability)).reshape(-1, 5)
    frames = tangents(own.axis)
    return Calibration(
        unit=session.unit,
        method=METHOD,
        sensors=tuple(
            _sensor(i, session, own, sigma, steady, frames[i], covariance, seen[k], known[i])
            for i in range(len(session.sensors))
        ),
        names=names(session.sensors),
        units=units(session.sensors),
        covariance=covariance,
        repeatability=repeatability,
        fit=_fit(k, session, solution, factor, unstated),
        residuals=_residuals(k, session, geometry, solution, own),
        gauge="stand",
    )


def _sensor(
    i: int,
    session: CalibrationSession,
    p: SensorParameters,
    sigma: Array,
    steady: Array,
    frame: Array,
    covariance: Array,
    seen: Array,
    known: tuple[KnownCombination, ...],
) -> SensorCalibration:
    """The estimates of sensor i."""

    def estimate(values: Array, element: int) -> Estimate:
        if not seen[i, element]:
            return Estimate(None, None)
        return Estimate(float(values[i]), float(sigma[i, element]), float(steady[i, element]))

    angles = slice(5 * i + 3, 5 * i + 5)
    return SensorCalibration(
        name=session.sensors[i].name,
        kind=session.sensors[i].kind,
        scale=estimate(p.scale, 0),
        bias=estimate(p.bias, 1),
        quadratic=estimate(p.quadratic, 2),
        axis=p.axis[i] if seen[i, 3] else None,
        axis_tangents=frame,
        axis_covariance=covariance[angles, angles],
        observable=dict(zip(("scale", "bias", "quadratic", "axis"), map(bool, seen[i, :4]), strict=True)),
        known=known,
    )


def _known(
    k: int, session: CalibrationSession, geometry: Geometry, solution: Fitted, y: Array, seen: Array
) -> list[tuple[KnownCombination, ...]]:
    """For each sensor the combinations that stand in for what is not observable."""
    p = solution.parameters
    found: list[tuple[KnownCombination, ...]] = []
    for i in range(len(session.sensors)):
        blind = {element for element, s in zip(("scale", "bias", "quadratic", "axis"), seen[i], strict=False) if not s}
        norm = float(geometry.norm[i])
        if not blind:
            found.append(())
        elif blind == observability.ONLY_TOGETHER:
            values = np.array([p.scale[k, i], p.bias[k, i], p.quadratic[k, i], 0.0, 0.0])
            found.append(observability.known_bias_quadratic(solution.information[k, i], values, norm))
        elif blind == {"quadratic"}:
            found.append(())
        else:
            variance = solution.variance[k, :, i] * p.scale[k, i] ** 2
            found.append(observability.known_linear(y[k, :, i], variance, geometry.n[:, i], norm))
    return found


def _fit(k: int, session: CalibrationSession, solution: Fitted, factor: Array, unstated: Array) -> Fit:
    """Quality of fit of session k."""
    determined = int(rank(solution.information)[k])
    dof = solution.residual[k].size - determined
    stated = not unstated[k].any()
    return Fit(
        chi2=float(solution.chi2[k]),
        dof=dof,
        p_value=noise.p_value(float(solution.chi2[k]), dof) if stated else None,
        residual_rms=float(np.sqrt(np.mean(solution.residual[k] ** 2))),
        noise="stated" if stated else "estimated",
        covariance_factor=float(factor[k]),
        rank=determined,
        parameters=5 * len(session.sensors),
        weakest=observability.weakest(solution.information[k], tuple(s.name for s in session.sensors)),
        iterations=solution.iterations,
        converged=solution.converged,
    )


def _residuals(
    k: int, session: CalibrationSession, geometry: Geometry, solution: Fitted, p: SensorParameters
) -> Residuals:
    """Residuals of session k with the noise each should have."""
    swing = slope(p, geometry.n) * projected(p.axis, geometry.beta) * geometry.beta_sigma
    return Residuals(
        value=solution.residual[k],
        sigma=np.sqrt(solution.variance[k] + swing**2),
        beta=session.beta,
        flipped=session.flipped,
        time=session.time,
        temperature=session.temperature,
    )
