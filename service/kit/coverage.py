"""The coverage factor that expanded uncertainties are stated with, in words."""

from estimator.coverage import coverage_factor
from estimator.message import say
from estimator.results import Calibration, SensorCalibration
from service.kit.measures import number


def coverage_in_words(calibration: Calibration, k: float) -> str:
    """``k = 2``, or the range that Student's t makes of it where the noise was estimated from few readings."""
    dofs = _degrees_of_freedom(calibration)
    if not dofs:
        return f"k = {number(k)}"
    most, least = (coverage_factor(k, dof) for dof in (min(dofs), max(dofs)))
    told = _range(min(dofs), max(dofs), 0)
    degrees = "one effective degree" if told == "1" else say("{told} effective degrees", told=told)
    return say(
        "k = {least}, by Student's t: the readings tell their noise to {degrees} of freedom",
        least=_range(least, most, 2),
        degrees=degrees,
    )


def noise_is_estimated(calibration: Calibration) -> bool:
    """Whether any uncertainty rests on noise that the readings themselves tell."""
    return bool(_degrees_of_freedom(calibration))


def _degrees_of_freedom(calibration: Calibration) -> list[float]:
    every = (dof for sensor in calibration.sensors for dof in (sensor.axis_dof, *_of_numbers(sensor)))
    return [dof for dof in every if dof is not None]


def _of_numbers(sensor: SensorCalibration) -> tuple[float | None, ...]:
    """Degrees of freedom of the parameters that are numbers."""
    return tuple(e.dof for e in (sensor.scale, sensor.bias, sensor.quadratic, sensor.misalignment) if e is not None)


def _range(low: float, high: float, digits: int) -> str:
    """``2.1 to 2.9``, or one number where both read the same."""
    first, last = number(low, digits), number(high, digits)
    return first if first == last else say("{first} to {last}", first=first, last=last)
