"""Blocks in unknown orientations whose truth is known, straight from u = K·(a + b + c·a²), a = g·e·d."""

from dataclasses import dataclass, replace

import numpy as np

from estimator.session import (
    ACCELEROMETER,
    ARBITRARY_ORIENTATIONS,
    GYROSCOPE,
    CalibrationSession,
    Sensor,
    Site,
)

G = 9.81


@dataclass(frozen=True, eq=False)
class Truth:
    """True parameters of the sensors, in the frame in which their axes show no net turn against the nominal ones."""

    nominal: np.ndarray
    axes: np.ndarray
    scale: np.ndarray
    bias: np.ndarray
    quadratic: np.ndarray

    def readings(self, directions):
        a = G * directions @ self.axes.T
        return self.scale * (a + self.bias + self.quadratic * a * a)


def sphere(count, rng):
    """(count, 3) unit vectors drawn evenly."""
    d = rng.standard_normal((count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def spread_axes(m):
    """(m, 3) axes: a triad for 3, else a cone with one along it, repeated with turned copies for many."""
    if m == 3:
        return np.eye(3)
    turn, half = 2 * np.pi * np.arange(m - 1) / (m - 1), np.radians(70)
    ring = np.column_stack([np.sin(half) * np.cos(turn), np.sin(half) * np.sin(turn), np.full(m - 1, np.cos(half))])
    return np.vstack([ring, [0.0, 0.0, 1.0]])


def without_net_turn(nominal, axes):
    """``axes`` turned so that they are nearest to ``nominal``."""
    U, _, Vt = np.linalg.svd(nominal.T @ axes)
    return axes @ (U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt).T


def truth(m, *, seed=0, tilt=0.01, bias=0.05, quadratic=0.0, scale_error=0.02, turn=True):
    rng = np.random.default_rng(seed)
    nominal = spread_axes(m)
    axes = nominal + tilt * rng.standard_normal((m, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    return Truth(
        nominal=nominal,
        axes=without_net_turn(nominal, axes) if turn else axes,
        scale=0.12 * (1 + scale_error * rng.standard_normal(m)),
        bias=bias * rng.standard_normal(m),
        quadratic=quadratic * rng.standard_normal(m),
    )


def session(true, directions, *, noise=1e-4, stated=True, rng=None, gyros=0, **changes):
    """A session; ``noise`` is one sigma at the input in m/s², the same for every sensor."""
    m, R = len(true.axes), len(directions)
    rng = rng or np.random.default_rng(7)
    sigma = noise * np.abs(true.scale)
    measured = CalibrationSession(
        unit="T-1",
        block=ACCELEROMETER,
        programme=ARBITRARY_ORIENTATIONS,
        sensors=tuple(Sensor(f"A{i + 1}", ACCELEROMETER, true.nominal[i], 0.12, "V") for i in range(m)),
        readings=true.readings(directions) + sigma * rng.standard_normal((R, m)),
        standard_errors=np.broadcast_to(sigma if stated else np.nan, (R, m)),
        site=Site(gravity=G),
    )
    return replace(with_gyros(measured, gyros, rng), **changes)


def with_gyros(measured, gyros, rng, bias=1e-3, noise=1e-6):
    """The session with resting gyros of a known bias after the accelerometers."""
    if not gyros:
        return measured
    R = len(measured.readings)
    earth = 7.292115e-5 * sphere(R * gyros, rng)[:, 0].reshape(R, gyros)
    readings = bias + earth + noise * rng.standard_normal((R, gyros))
    sensors = tuple(Sensor(f"G{i + 1}", GYROSCOPE, np.eye(3)[i % 3], 1.0, "rad/s") for i in range(gyros))
    return replace(
        measured,
        sensors=measured.sensors + sensors,
        readings=np.hstack([measured.readings, readings]),
        standard_errors=np.hstack([measured.standard_errors, np.full((R, gyros), noise)]),
    )


def errors(result, true):
    """(5 m,) estimate minus truth in the order and units of the result's covariance."""
    found = []
    for i, sensor in enumerate(result.sensors):
        turn = sensor.axis_tangents.T @ (true.axes[i] - sensor.axis)
        c = 0.0 if sensor.quadratic.value is None else sensor.quadratic.value - true.quadratic[i]
        found += [sensor.scale.value - true.scale[i], sensor.bias.value - true.bias[i], c, -turn[0], -turn[1]]
    return np.array(found)
