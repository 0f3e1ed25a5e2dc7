"""Applies a calibration, as firmware does: readings back to specific force or angular rate in block axes.

Theory
------
The sensor model u = K·(a + b + c·a²) is inverted sensor by sensor,

    y = (u − u₀)/(T·K) − b,    a = 2·y/(1 + √(1 + 4·c·y)),

with u₀ the stated offset of the readings and T the count time of a pulse gyro (1 otherwise). This form of the root of
c·a² + a − y = 0 is the one that goes to y as c goes to zero, and loses no digits there. The components a = E·f along
m ≥ 3 input axes, the rows of E, give the vector by least squares, f = M·a with M = (EᵀE)⁻¹Eᵀ.

To first order an error of the parameters moves f by M·(∂a/∂p·δp − δE·f): that gives the uncertainty of f that the
calibration brings, before the noise of the reading.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.curves import Curve, ThermalCurves
from estimator.message import joined, say
from estimator.parameters import ELEMENTS
from estimator.results import Calibration, SensorCalibration
from estimator.session import GYROSCOPE, Array, CalibrationSession

FLATTEST = 1e-6
"""Smallest singular value of the axes, relative to the largest, that still gives all three components: beyond, a
reading's last digit would be the whole of one."""


@dataclass(frozen=True, eq=False)
class SensorCorrection:
    """The inversion of one sensor."""

    name: str
    kind: str
    reading_unit: str
    offset: float
    """u₀, reading units."""
    count_time: float | None
    """T, s; None unless the readings are pulse counts."""
    scale: float
    """Reading units per m/s² (rad/s)."""
    bias: float
    """m/s² (rad/s)."""
    quadratic: float
    """s²/m (s/rad); 0 where the session does not observe it."""
    quadratic_known: bool
    axis: Array
    """(3,) unit vector, block axes."""
    tangents: Array
    """(3, 2) tangents of the axis, for its covariance."""

    def input(self, readings: Array) -> Array:
        """y of readings (R,), or of any shape, reading units: the same shape, m/s² (rad/s)."""
        return (readings - self.offset) / ((self.count_time or 1.0) * self.scale) - self.bias

    def component(self, readings: Array) -> Array:
        """a, the component along the input axis, m/s² (rad/s), of readings (R,), or of any shape, reading units.

        NaN beyond the turn of the parabola.
        """
        y = self.input(readings)
        with np.errstate(invalid="ignore"):
            return 2.0 * y / (1.0 + np.sqrt(1.0 + 4.0 * self.quadratic * y))


@dataclass(frozen=True, eq=False)
class BlockCorrection:
    """The sensors of one kind and the matrix that joins them. m sensors."""

    kind: str
    sensors: tuple[SensorCorrection, ...]
    matrix: Array
    """(3, m) M, dimensionless."""
    covariance: Array
    """(5 m, 5 m) covariance of scale, bias, quadratic, axis_1, axis_2, sensor after sensor, SI; 0 for what is taken as
    known.
    """

    def components(self, readings: Array) -> Array:
        """a of readings (R, m), leading axes free, reading units: the same shape, m/s² (rad/s)."""
        return np.stack([s.component(readings[..., i]) for i, s in enumerate(self.sensors)], axis=-1)

    def vector(self, readings: Array) -> Array:
        """Specific force or angular rate (R, 3), m/s² (rad/s), block axes, of readings (R, m), leading axes free."""
        return self.components(readings) @ self.matrix.T

    def vector_covariance(self, readings: Array) -> Array:
        """(3, 3), (m/s²)² or (rad/s)², of the vector of one set of readings (m,), from the calibration alone."""
        a, f = self.components(readings), self.vector(readings)
        columns = []
        for i, sensor in enumerate(self.sensors):
            slope = 1.0 + 2.0 * sensor.quadratic * a[i]
            by_scale = -(a[i] + sensor.bias + sensor.quadratic * a[i] ** 2) / sensor.scale
            partials = [by_scale / slope, -1.0 / slope, -(a[i] ** 2) / slope, *(-sensor.tangents.T @ f)]
            columns.append(np.outer(self.matrix[:, i], partials))
        jacobian = np.concatenate(columns, axis=1)
        total: Array = jacobian @ self.covariance @ jacobian.T
        return total


@dataclass(frozen=True, eq=False)
class Correction:
    """The corrections that a calibration gives, and the sensors that it cannot correct."""

    blocks: tuple[BlockCorrection, ...]
    """One a kind of sensor whose axes span all three directions."""
    left_out: tuple[tuple[str, str], ...]
    """Sensors without a correction, and why."""


def correction_of(session: CalibrationSession, calibration: Calibration) -> Correction:
    """The correction that a calibration of a session gives.

    Parameters
    ----------
    session : what was measured; its offsets and count time are part of the correction.
    calibration : of every sensor of it.
    """
    blocks, left_out = [], []
    for kind in dict.fromkeys(s.kind for s in calibration.sensors):
        of_this_kind = [s for s in calibration.sensors if s.kind == kind]
        unseen = {s.name: why for s in of_this_kind if (why := _unseen(s))}
        sensors = tuple(_sensor(session, s) for s in of_this_kind if s.name not in unseen)
        left_out += list(unseen.items())
        if _spans(sensors):
            axes = np.stack([s.axis for s in sensors])
            blocks.append(BlockCorrection(kind, sensors, np.linalg.pinv(axes), _covariance(calibration, sensors)))
        else:
            left_out += [
                (s.name, say("the axes of the {kind}s do not span three directions", kind=kind)) for s in sensors
            ]
    return Correction(tuple(blocks), tuple(left_out))


def _unseen(sensor: SensorCalibration) -> str:
    """The parameters missing for an inversion, as a message; a quadratic term may be missing."""
    missing = [name for name in ("scale", "bias", "axis") if not sensor.observable.get(name, False)]
    return say("the session does not observe its {missing}", missing=joined(", ", missing)) if missing else ""


def _spans(sensors: Sequence[SensorCorrection]) -> bool:
    """Whether the axes reach all three directions."""
    if len(sensors) < 3:
        return False
    size = np.linalg.svd(np.stack([s.axis for s in sensors]), compute_uv=False)
    return bool(size[2] > FLATTEST * size[0])


def _sensor(session: CalibrationSession, calibration: SensorCalibration) -> SensorCorrection:
    declared = next(s for s in session.sensors if s.name == calibration.name)
    assert calibration.scale.value is not None
    assert calibration.bias.value is not None
    assert calibration.axis is not None
    return SensorCorrection(
        name=calibration.name,
        kind=calibration.kind,
        reading_unit=declared.reading_unit,
        offset=declared.nominal_offset or 0.0,
        count_time=session.count_time if calibration.kind == GYROSCOPE else None,
        scale=calibration.scale.value,
        bias=calibration.bias.value,
        quadratic=calibration.quadratic.value or 0.0,
        quadratic_known=calibration.quadratic.value is not None,
        axis=calibration.axis,
        tangents=calibration.axis_tangents,
    )


def _covariance(calibration: Calibration, sensors: Sequence[SensorCorrection]) -> Array:
    """(5 m, 5 m) covariance of the sensors' parameters, SI; 0 for what is taken as known, NaN where the noise is
    unknown.
    """
    places = [calibration.names.index(f"{s.name}.{element}") for s in sensors for element in ELEMENTS]
    assumed = np.array([element == "quadratic" and not s.quadratic_known for s in sensors for element in ELEMENTS])
    return np.where(assumed | assumed[:, None], 0.0, calibration.covariance[np.ix_(places, places)])


def at_temperature(calibration: Calibration, temperature: float) -> Calibration:
    """The calibration as it is at a temperature, °C, with the band's uncertainty; itself where it has no curves.

    Correlations with axes and quadratic terms are left out: these are the same at every temperature.
    """
    curves = calibration.thermal
    if curves is None:
        return calibration
    known, covariance = {s.name: s for s in curves.sensors}, calibration.covariance.copy()
    sensors = []
    for sensor in calibration.sensors:
        fitted = known.get(sensor.name)
        parts = {} if fitted is None else {"scale": fitted.scale, "bias": fitted.bias}
        moved = {name: _at(curves, curve, temperature) for name, curve in parts.items() if curve is not None}
        places = [calibration.names.index(f"{sensor.name}.{name}") for name in moved]
        block = np.diag([sigma**2 for _, sigma in moved.values()])
        if fitted is not None and fitted.cross is not None:
            powers = curves.powers(np.array([temperature]), len(fitted.cross))[0]
            block[0, 1] = block[1, 0] = powers @ fitted.cross @ powers
        if moved:
            covariance[places], covariance[:, places] = 0.0, 0.0
            covariance[np.ix_(places, places)] = block
        changed = {n: replace(getattr(sensor, n), value=value, sigma=sigma) for n, (value, sigma) in moved.items()}
        sensors.append(replace(sensor, **changed))
    return replace(calibration, sensors=tuple(sensors), covariance=covariance)


def _at(curves: ThermalCurves, curve: Curve, temperature: float) -> tuple[float, float]:
    """Value and one sigma, SI, at a temperature, °C."""
    at = np.array([temperature])
    return float(curves.value(curve, at)[0]), float(curves.sigma(curve, at)[0])
