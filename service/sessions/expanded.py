"""U of a calibrated parameter, by itself."""

from estimator.results import Estimate, SensorCalibration


def expanded_of(sensor: SensorCalibration, parameter: str, k: float) -> float | None:
    """U, SI; of a scale factor relative. None where it is not known."""
    if not sensor.observable[parameter]:
        return None
    if parameter == "axis":
        sigma: float | None = sensor.axis_sigma
    else:
        estimate: Estimate = getattr(sensor, parameter)
        sigma = estimate.sigma
        if parameter == "scale" and sigma is not None and estimate.value:
            sigma /= abs(estimate.value)
    return None if sigma is None else sensor.factor(parameter, k) * sigma
