"""Step: does a reference tell enough of a unit for it to be used, before any session was held against it?

A later session is judged by U against T. A reference whose own U of a parameter is larger than T, or that does not show
it, could neither be judged nor judge another.
"""

from collections.abc import Iterator, Mapping

from estimator.message import say
from estimator.results import Calibration, Estimate, SensorCalibration
from service.sessions.records import PARAMETERS


def left_uncertain(
    calibration: Calibration, tolerances: Mapping[tuple[str, str], float], coverage_factor: float
) -> Iterator[str]:
    """``A1 scale``: every parameter that has a tolerance and is not known to it."""
    for sensor in calibration.sensors:
        for parameter in PARAMETERS:
            tolerance = tolerances.get((sensor.kind, parameter))
            if tolerance is None or parameter not in sensor.observable:
                continue
            expanded = _expanded(sensor, parameter, coverage_factor)
            if expanded is None or expanded > tolerance:
                yield say("{name} {parameter}", name=sensor.name, parameter=parameter)


def _expanded(sensor: SensorCalibration, parameter: str, k: float) -> float | None:
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
