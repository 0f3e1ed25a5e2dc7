"""A hand that turns a block of accelerometers and gyros and sets it down again, by exact rotations.

The attitude is a closed form of time: a turn about one axis, of smooth angle, times three oscillations that fade in and
out. Rates are its difference quotient over 40 µs, and nothing here integrates them. Shares no code with the estimator.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from estimator.session import (
    ACCELEROMETER,
    ARBITRARY_ORIENTATIONS,
    GYROSCOPE,
    CalibrationSession,
    Sensor,
    Site,
)

Array = NDArray[np.float64]
GRAVITY = 9.81
EARTH = 7.292115e-5
"""rad/s"""
LATITUDE = np.radians(52.0)
H = 2e-5
"""s; half the span of a difference quotient."""
INSIDE = 4
"""Instants within a sample that it is the mean of."""


@dataclass(frozen=True)
class World:
    """Whatever is simulated."""

    gyros: int = 3
    rests: int = 40
    rate: float = 100.0
    rest: float = 5.0
    """s"""
    gyro_noise: float = 2e-3
    """rad/s a sample"""
    accelerometer_noise: float = 1e-2
    """m/s² a sample"""
    quantum: tuple[float, float] = (2e-4, 2e-3)
    """rad/s and m/s²"""
    force: float = 0.0
    """One sigma of each component of g-sensitivity, (rad/s)/(m/s²)."""
    labelled: bool = True
    units: float = 1.0
    """Factor of all gyro readings that nobody states."""
    signs: tuple[float, ...] = ()
    """Factor of each gyro's readings; 1 where not given."""


@dataclass(frozen=True, eq=False)
class Motion:
    """One turn: C(t) = C_0·exp(φ·s(t))·exp(wobble(t)), 0 ≤ t ≤ T."""

    begin: Rotation
    vector: Array
    duration: float
    size: Array
    frequency: Array
    phase: Array
    push: Array
    """(3,) amplitude of the hand's acceleration, m/s²."""

    def attitude(self, t: Array) -> Rotation:
        """At times (n,), s."""
        x = np.clip(t / self.duration, 0, 1)
        s = x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)
        fade = np.sin(np.pi * x) ** 4
        wobble = fade[:, None] * self.size * np.sin(2 * np.pi * self.frequency * t[:, None] + self.phase)
        return self.begin * Rotation.from_rotvec(s[:, None] * self.vector) * Rotation.from_rotvec(wobble)

    def rate(self, t: Array) -> Array:
        """(n, 3) rad/s, block axes, against the Earth."""
        return (self.attitude(t - H).inv() * self.attitude(t + H)).as_rotvec() / (2 * H)

    def force(self, t: Array) -> Array:
        """(n, 3) specific force, m/s², block axes."""
        x = np.clip(t / self.duration, 0, 1)
        pushed = self.push * np.sin(2 * np.pi * x[:, None]) * np.sin(np.pi * x[:, None]) ** 2
        return self.attitude(t).inv().apply(pushed + np.array([0.0, 0.0, GRAVITY]))


@dataclass(frozen=True, eq=False)
class Truth:
    """A log's truth. Frame: that in which the accelerometers' axes show no net turn against the nominal ones."""

    session: CalibrationSession
    scale: Array
    bias: Array
    axes: Array
    force: Array
    """(m, 3) answer to force at the input, (rad/s)/(m/s²)."""
    clean: Array
    """(N, 3 + m) readings without noise or rounding, of the units and signs that the session states."""
    labels: NDArray[np.int64]
    """(N,) rest of each sample; −1 in turns."""
    world: World


def nominal_axes(m: int) -> Array:
    """(m, 3) unit vectors: a triad, or a cone of half angle 55°."""
    if m == 3:
        return np.eye(3)
    turn = 2 * np.pi * np.arange(m) / m
    half = np.radians(55)
    return np.column_stack([np.sin(half) * np.cos(turn), np.sin(half) * np.sin(turn), np.full(m, np.cos(half))])


def path(world: World, rng: np.random.Generator) -> tuple[Array, Array, NDArray[np.int64]]:
    """Rates (N, 3), rad/s, forces (N, 3), m/s², and labels (N,) of samples."""
    n_rest, here = round(world.rest * world.rate), Rotation.random(rng=rng)
    rates, forces, labels = [], [], []
    earth = EARTH * np.array([np.cos(LATITUDE), 0.0, np.sin(LATITUDE)])
    inside = (np.arange(INSIDE) + 0.5) / INSIDE
    for k in range(world.rests):
        still = here.inv().apply(np.array([earth, [0.0, 0.0, GRAVITY]]))
        rates.append(np.tile(still[0], (n_rest, 1)))
        forces.append(np.tile(still[1], (n_rest, 1)))
        labels.append(np.full(n_rest, k))
        if k == world.rests - 1:
            break
        axis = rng.standard_normal(3)
        n = round(rng.uniform(2.0, 4.0) * world.rate)
        motion = Motion(
            here, axis / np.linalg.norm(axis) * rng.uniform(1.0, 2.8), n / world.rate, rng.uniform(0.05, 0.2, 3),
            rng.uniform(0.5, 3.0, 3), rng.uniform(0, 2 * np.pi, 3), rng.uniform(-2, 2, 3),
        )  # fmt: skip
        t = ((np.arange(n)[:, None] + inside) / world.rate).ravel()
        rate = motion.rate(t) + motion.attitude(t).inv().apply(earth)
        rates.append(rate.reshape(n, INSIDE, 3).mean(axis=1))
        forces.append(motion.force(t).reshape(n, INSIDE, 3).mean(axis=1))
        labels.append(np.full(n, -1))
        here = motion.attitude(np.array([n / world.rate]))[0]
    return np.concatenate(rates), np.concatenate(forces), np.concatenate(labels)


def off_nominal(nominal: Array, rng: np.random.Generator, *, held: bool) -> Array:
    """Axes (m, 3) half a degree off nominal; ``held``: without net turn against them."""
    axes = nominal + 0.01 * rng.standard_normal(nominal.shape)
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    if held:
        U, _, V = np.linalg.svd(nominal.T @ axes)
        axes = axes @ (U @ np.diag([1, 1, np.linalg.det(U @ V)]) @ V).T
    return axes


def simulated(world: World, rng: np.random.Generator) -> Truth:
    """A log with what is true of it."""
    rate, force, labels = path(world, rng)
    m, lsb = world.gyros, world.quantum
    nominal, factor = nominal_axes(m), np.ones(m)
    axes, of_force = off_nominal(nominal, rng, held=False), off_nominal(np.eye(3), rng, held=True)
    factor[: len(world.signs)] = world.signs
    scale = 1 + 0.02 * rng.standard_normal(m)
    bias, answer = 0.01 * rng.standard_normal(m), world.force * rng.standard_normal((m, 3))
    clean_gyros = scale * (rate @ axes.T + bias + force @ answer.T)
    gains, zeros = 1 + 0.02 * rng.standard_normal(3), 0.1 * rng.standard_normal(3)
    clean_force = gains * (force @ of_force.T + zeros)
    gyros = clean_gyros + world.gyro_noise * rng.standard_normal(clean_gyros.shape)
    accelerometers = clean_force + world.accelerometer_noise * rng.standard_normal(clean_force.shape)
    gyros, accelerometers = lsb[0] * np.round(gyros / lsb[0]), lsb[1] * np.round(accelerometers / lsb[1])
    sensors = (
        *(Sensor(f"A{i + 1}", ACCELEROMETER, np.eye(3)[i], 1.0, "m/s²") for i in range(3)),
        *(Sensor(f"G{i + 1}", GYROSCOPE, nominal[i], 1.0, "rad/s") for i in range(m)),
    )
    readings = np.hstack([accelerometers, world.units * factor * gyros])
    session = CalibrationSession(
        unit="hand", block=ACCELEROMETER, programme=ARBITRARY_ORIENTATIONS, sensors=sensors, readings=readings,
        standard_errors=np.full(readings.shape, np.nan), site=Site(latitude=LATITUDE, gravity=GRAVITY),
        sample_rate=world.rate, position=labels if world.labelled else None,
    )  # fmt: skip
    return Truth(session, scale, bias, axes, answer, np.hstack([clean_force, clean_gyros]), labels, world)
