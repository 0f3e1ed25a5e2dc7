"""Calibrations with chosen parameters and uncertainties, for the tests of decisions."""

import numpy as np

from estimator.results import Calibration, Estimate, Fit, Residuals, SensorCalibration
from estimator.session import ACCELEROMETER, Array

TANGENTS = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
"""Of the axis Z."""
TOLERANCES = {
    (ACCELEROMETER, "scale"): 1e-4,
    (ACCELEROMETER, "bias"): 5e-4,
    (ACCELEROMETER, "quadratic"): 2e-6,
    (ACCELEROMETER, "axis"): 1e-4,
}


def axis_at(offset: Array) -> Array:
    """The unit vector at an angle from Z along its tangents, rad."""
    angle = float(np.hypot(*offset))
    if angle == 0:
        return np.array([0.0, 0.0, 1.0])
    return np.array([*(np.sin(angle) * offset / angle), np.cos(angle)])


def sensor(
    name: str = "A1",
    *,
    scale: tuple[float, float] = (0.12, 0.0),
    bias: tuple[float | None, float | None] = (0.0, 0.0),
    quadratic: tuple[float | None, float | None] = (0.0, 0.0),
    offset: tuple[float, float] = (0.0, 0.0),
    covariance: Array | None = None,
) -> SensorCalibration:
    """A sensor along Z; every pair is value and one sigma."""
    return SensorCalibration(
        name=name,
        kind=ACCELEROMETER,
        scale=Estimate(*scale),
        bias=Estimate(*bias),
        quadratic=Estimate(*quadratic),
        axis=axis_at(np.array(offset)),
        axis_tangents=TANGENTS,
        axis_covariance=np.zeros((2, 2)) if covariance is None else covariance,
        observable={"scale": True, "bias": bias[0] is not None, "quadratic": quadratic[0] is not None, "axis": True},
    )


def calibration(*sensors: SensorCalibration, noise: str = "stated", dof: int = 50) -> Calibration:
    """A calibration of these sensors; what decisions do not read is empty."""
    count = 5 * len(sensors)
    nothing = np.zeros((0, len(sensors)))
    return Calibration(
        unit="U",
        method="test",
        sensors=sensors,
        names=("",) * count,
        units=("",) * count,
        covariance=np.zeros((count, count)),
        repeatability=np.zeros((count, count)),
        fit=Fit(float(dof), dof, 0.5, 0.0, noise, 1.0, count, count, ("", 0.0), 1, True),
        residuals=Residuals(nothing, nothing, None, None, None, None),
        gauge="stand",
    )
