"""A recording's result in the terms of a calibration, so that it is stored, drawn and judged like every other.

Of every parameter: the reference's value and the change that the recording shows, each as if it alone had changed, or
beside the change of the isolated sensor. The uncertainty is that of the change. Of the second-order term parity says
nothing. Where a sensor fails within the recording, the part before tells the parameters.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from estimator.arrays import unit
from estimator.parity.results import NOTHING, ParityResult, SensorParity, Sight
from estimator.results import Calibration, Estimate, Fit, Residuals, SensorCalibration
from estimator.session import ACCELEROMETER, Array

METHOD = "in-service/parity"


def before_faults(result: ParityResult) -> ParityResult:
    """The part before a sensor fails; where that is too short, nothing is seen of any sensor."""
    if not result.faults:
        return result
    blind = tuple(replace(sensor, bias=NOTHING, scale=NOTHING, axis=NOTHING) for sensor in result.sensors)
    return result.before or replace(result, sensors=blind)


def parity_calibration(result: ParityResult, reference: Calibration) -> Calibration:
    """The reference moved by what the recording shows, sensor by sensor; ``parity`` holds the whole result."""
    known = before_faults(result)
    pairs = [(sensor, reference.sensor(sensor.name)) for sensor in known.sensors]
    sensors = tuple(moved(sensor, known) for sensor, known in pairs)
    covariance = block_diag(*(covariance_of(sensor, known) for sensor, known in pairs))
    places = [reference.names.index(name) for name in names(known)]
    return Calibration(
        unit=result.unit,
        method=METHOD,
        sensors=sensors,
        names=names(known),
        units=tuple(reference.units[k] for k in places),
        covariance=covariance,
        repeatability=covariance,
        fit=fit(known),
        residuals=Residuals(
            value=known.course,
            sigma=np.broadcast_to(known.course_sigma, known.course.shape),
            beta=None,
            flipped=None,
            time=known.course_time,
            temperature=None,
        ),
        gauge="parity",
        site=reference.site,
        parity=result.to_dict(),
    )


def names(result: ParityResult) -> tuple[str, ...]:
    """Scale, bias, axis_1 and axis_2 of every sensor."""
    return tuple(f"{s.name}.{element}" for s in result.sensors for element in ("scale", "bias", "axis_1", "axis_2"))


def moved(sensor: SensorParity, known: SensorCalibration) -> SensorCalibration:
    """One sensor: reference and change."""
    assert known.scale.value is not None
    assert known.axis is not None
    turns = sensor.axis.change
    return SensorCalibration(
        name=known.name,
        kind=known.kind,
        scale=changed(known.scale, sensor.scale, known.scale.value),
        bias=changed(known.bias, sensor.bias, 1.0),
        quadratic=Estimate(None, None),
        axis=None if turns is None else unit(known.axis + known.axis_tangents @ np.array(turns)),
        axis_tangents=known.axis_tangents,
        axis_covariance=square(sensor.axis, 2),
        observable={part: getattr(sensor, part).change is not None for part in ("scale", "bias", "axis")},
    )


def changed(known: Estimate, sight: Sight, unit_size: float) -> Estimate:
    """The reference's value and its change; the change is in units of ``unit_size``."""
    if sight.size is None or sight.sigma is None or known.value is None:
        return Estimate(None, None)
    sigma = abs(unit_size) * sight.sigma
    return Estimate(known.value + unit_size * sight.size, sigma, sigma)


def square(sight: Sight, size: int) -> Array:
    """(n, n) covariance of a sight of n numbers, relative, SI or rad, squared; NaN where nothing is seen."""
    return np.full((size, size), np.nan) if sight.covariance is None else np.array(sight.covariance)


def covariance_of(sensor: SensorParity, known: SensorCalibration) -> Array:
    """(4, 4) covariance of one sensor's scale (reading units per m/s²), bias (m/s²) and axis (rad), each by itself."""
    scale = known.scale.value or 1.0
    return np.asarray(block_diag(scale**2 * square(sensor.scale, 1), square(sensor.bias, 1), square(sensor.axis, 2)))


def fit(result: ParityResult) -> Fit:
    """χ² of no change at all."""
    biases = [(s.bias.sigma, s.name) for s in result.sensors if s.bias.sigma is not None]
    worst = max(biases, default=(float("nan"), result.sensors[0].name))
    zero = "m/s²" if result.kind == ACCELEROMETER else "rad/s"
    return Fit(
        chi2=result.chi2,
        dof=result.dof,
        p_value=result.p_value,
        residual_rms=result.residual_rms,
        noise="estimated",
        covariance_factor=1.0,
        rank=result.dof,
        parameters=4 * len(result.sensors),
        weakest=(f"{worst[1]}.bias ({zero})", worst[0]),
        iterations=1,
        converged=True,
    )
