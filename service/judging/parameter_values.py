"""Step: a calibration as the rows of the history, one a sensor and parameter."""

from estimator.results import Calibration, Estimate, SensorCalibration
from service.sessions.records import ALL_PARAMETERS, ParameterValue


def parameter_values(calibration: Calibration) -> tuple[ParameterValue, ...]:
    """Every parameter that the session speaks of; what was not observed has neither value nor uncertainty."""
    return tuple(
        _value(index, sensor, parameter)
        for index, sensor in enumerate(calibration.sensors)
        for parameter in ALL_PARAMETERS
        if parameter in sensor.observable
    )


def _value(index: int, sensor: SensorCalibration, parameter: str) -> ParameterValue:
    if parameter == "axis":
        axis = None if sensor.axis is None else (float(sensor.axis[0]), float(sensor.axis[1]), float(sensor.axis[2]))
        return ParameterValue(sensor.name, index, sensor.kind, parameter, None, sensor.axis_sigma, axis)
    estimate: Estimate = getattr(sensor, parameter)
    return ParameterValue(sensor.name, index, sensor.kind, parameter, estimate.value, estimate.sigma, None)
