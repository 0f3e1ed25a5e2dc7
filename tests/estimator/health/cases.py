"""Calibrations with chosen parameters and uncertainties, for the tests of decisions."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.arrays import tangents
from estimator.parameters import ELEMENTS
from estimator.results import Calibration, Estimate, Fit, Residuals, SensorCalibration
from estimator.session import ACCELEROMETER, Array

TANGENTS = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
"""Tangents of the axis Z."""
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


def block(axes: Array, change: Array, covariance: Array, turn: Array, gauge: str = "stand") -> Calibration:
    """Sensors A1, A2, … on axes (m, 3), each changed by (m, 5) SI elements, the block turned by a rotation vector."""
    basis = tangents(axes)
    moved = axes + (basis @ change[:, 3:, None])[..., 0]
    moved /= np.linalg.norm(moved, axis=1, keepdims=True)
    basis = basis - moved[..., None] @ (moved[:, None, :] @ basis)
    turned = Rotation.from_rotvec(turn)
    sensors = tuple(_sensor(i, turned.apply(moved[i]), turned.apply(basis[i].T).T, change[i], covariance)
                    for i in range(len(axes)))  # fmt: skip
    made = calibration(*sensors)
    names = tuple(f"{s.name}.{element}" for s in sensors for element in ELEMENTS)
    return replace(made, names=names, covariance=covariance, gauge=gauge)


def _sensor(i: int, axis: Array, basis: Array, change: Array, covariance: Array) -> SensorCalibration:
    sigma = np.sqrt(np.diagonal(covariance)[5 * i : 5 * i + 5])
    return replace(
        sensor(f"A{i + 1}", covariance=covariance[5 * i + 3 : 5 * i + 5, 5 * i + 3 : 5 * i + 5]),
        scale=Estimate(0.12 + change[0], sigma[0]),
        bias=Estimate(change[1], sigma[1]),
        quadratic=Estimate(change[2], sigma[2]),
        axis=axis,
        axis_tangents=basis,
    )
