"""The `Calibration` of a block in unknown orientations, from what is known of its sensors."""

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite

import numpy as np

from estimator.arrays import tangents
from estimator.calibration.free.completion import completion
from estimator.calibration.free.gyros import GyroBiases
from estimator.calibration.free.knowledge import Knowledge
from estimator.calibration.free.solve import Solution
from estimator.coverage import finite, positions_to_add
from estimator.parameters import names, units
from estimator.results import PARAMETERS, Calibration, Estimate, Fit, ForceAnswer, Residuals, SensorCalibration
from estimator.session import Array, CalibrationSession
from estimator.significance import p_value

METHOD = "arbitrary-orientations/maximum-likelihood"
"""Name of the method in results."""


def fit_of_accelerometers(
    solution: Solution, used: Solution, known: Knowledge, stated: bool, element_names: tuple[str, ...]
) -> Fit:
    """Quality of fit of the accelerometers.

    Parameters
    ----------
    solution : under the stated (or estimated) noise; χ² and p-value are its.
    used : under the noise that explains the residuals.
    element_names : of the accelerometers.
    """
    lead, sigma = used.knowledge.weakest
    return Fit(
        chi2=solution.chi2,
        dof=solution.dof,
        p_value=float(p_value(solution.chi2, solution.dof)) if stated and solution.dof > 0 else None,
        residual_rms=float(np.sqrt(np.mean(known.residual[solution.rows.takes_part] ** 2))),
        noise="stated" if stated else "estimated",
        covariance_factor=1.0 if used is solution else solution.chi2 / solution.dof,
        rank=used.knowledge.rank,
        parameters=used.knowledge.parameters,
        weakest=(element_names[lead], sigma),
        iterations=used.iterations,
        converged=used.converged,
        add=() if used.knowledge.full else to_add(used),
        positions_to_add=0 if used.knows_noise else more_positions(used),
    )


def more_positions(solution: Solution) -> int:
    """Number of orientations, unlabelled and of any direction, that determine all parameters and the noise to `WANTED`
    degrees of freedom.
    """
    missing = solution.knowledge.parameters - solution.knowledge.rank
    return positions_to_add(-missing, solution.rows.y.shape[1] - 2)


def to_add(solution: Solution) -> tuple[tuple[float, float, float], ...]:
    """Directions of up that complete what the orientations leave open."""
    rows, up = solution.rows, solution.unknowns.directions
    sigma = None if not rows.held else float(rows.prior.max() ** -0.5)
    directions = completion(rows.nominal_axes, up, quadratic=solution.quadratic, direction_sigma=sigma)
    return tuple((float(x), float(y), float(z)) for x, y, z in directions)


def fit_of_gyros(gyros: GyroBiases, element_names: tuple[str, ...]) -> Fit:
    """Quality of fit of one bias a gyro, the Earth's rate counted as noise; for a block of gyros alone."""
    worst = int(np.argmax(gyros.sigma))
    return Fit(
        chi2=gyros.chi2,
        dof=gyros.dof,
        p_value=float(p_value(gyros.chi2, gyros.dof)) if gyros.stated and gyros.dof > 0 else None,
        residual_rms=float(np.sqrt(np.mean(gyros.residual**2))),
        noise="stated" if gyros.stated else "estimated",
        covariance_factor=1.0,
        rank=len(gyros.bias),
        parameters=len(gyros.bias),
        weakest=(element_names[5 * worst + 1], 1.0),
        iterations=0,
        converged=True,
        positions_to_add=positions_to_add(0, 1) if np.isnan(gyros.freedom).any() else 0,
    )


Answers = Mapping[int, ForceAnswer | None]
"""Answers of gyros to force, by their place among the sensors."""


def sensor_result(i: int, known: Knowledge, sigma: Array, session: CalibrationSession) -> SensorCalibration:
    """The result of sensor i; ``sigma`` (m, 5), SI."""
    p, sensor, elements = known.parameters, session.sensors[i], slice(5 * i + 3, 5 * i + 5)
    seen = [bool(s) for s in known.observable[i]]
    values = (float(p.scale[i]), float(p.bias[i]), float(p.quadratic[i]))
    freedom = known.freedom[5 * i : 5 * i + 5].tolist()
    scale, bias, quadratic = (
        estimate(v, s, f) if ok else Estimate(None, None)
        for v, s, f, ok in zip(values, sigma[i, :3].tolist(), freedom[:3], seen[:3], strict=True)
    )
    return SensorCalibration(
        name=sensor.name,
        kind=sensor.kind,
        scale=scale,
        bias=bias,
        quadratic=quadratic,
        axis=p.axis[i] if seen[3] else None,
        axis_tangents=tangents(p.axis[i]),
        axis_covariance=known.covariance[elements, elements],
        observable=dict(zip(PARAMETERS, seen, strict=False)),
        known=known.known[i],
        axis_dof=finite(float(known.freedom[5 * i + 3 : 5 * i + 5].min())),
    )


def estimate(value: float, sigma: float, freedom: float) -> Estimate:
    """A value with its one sigma, of one unit, NaN where the noise cannot be estimated; its degrees of freedom."""
    return Estimate(value, sigma, sigma, finite(freedom)) if isfinite(sigma) else Estimate(value, None)


def report(
    session: CalibrationSession, known: Knowledge, fit: Fit, gauge: str, answers: Answers | None = None
) -> Calibration:
    """The calibration of all that is known, named."""
    sigma = np.sqrt(np.diagonal(known.covariance)).reshape(-1, 5)
    sensors = [sensor_result(i, known, sigma, session) for i in range(len(session.sensors))]
    return Calibration(
        unit=session.unit,
        method=METHOD,
        sensors=tuple(replace(s, g_sensitivity=(answers or {}).get(i)) for i, s in enumerate(sensors)),
        names=names(session.sensors),
        units=units(session.sensors),
        covariance=known.covariance,
        repeatability=known.covariance,
        fit=fit,
        residuals=Residuals(
            value=known.residual,
            sigma=known.noise,
            beta=None,
            flipped=None,
            time=session.time,
            temperature=session.temperature,
            enlarged_by=1.0,
        ),
        gauge=gauge,
        site=session.site,
        screening=session.screening,
        set_aside=session.set_aside,
    )
