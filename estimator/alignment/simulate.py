"""Turntable sessions whose truth is known: true attitude → what each sensor reads, with errors and noise."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.alignment.levers import coefficients
from estimator.alignment.sins import earth_rate
from estimator.alignment.strapdown import BlockMotion
from estimator.applied_vector import STANDARD_GRAVITY, gravity
from estimator.results import ARCSEC
from estimator.session import (
    ACCELEROMETER,
    GYROSCOPE,
    RATE_TABLE,
    ROTATION_ALIGNMENT,
    Array,
    CalibrationSession,
    Sensor,
    Site,
    Stand,
    StandErrors,
)


@dataclass(frozen=True)
class TurntableProgramme:
    """Stops and turns of a turntable."""

    angles: tuple[float, ...] = (0.0, np.pi)
    """rad, of each stop in order; may pass 2π."""
    dwell: float = 300.0
    """s at each stop."""
    rate: float = np.radians(6.0)
    """rad/s between stops."""
    row: float = 0.1
    """Time of a row, s."""
    ramp: float = 0.0
    """s in which the table comes up to its rate, evenly, and in which it stops again; 0 for at once."""


@dataclass(frozen=True, eq=False)
class Truth:
    """The true errors and attitude of the block; SI."""

    gyro_bias: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) rad/s."""
    accelerometer_bias: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) m/s²."""
    mounting: tuple[float, float] = (0.0, 0.0)
    """E_xz, E_yz, rad."""
    kappa: float = 0.0
    """Relative scale error of the azimuth gyro."""
    heading: float = 0.0
    """rad by which the table at angle 0 is turned from x east, y north, to the left."""
    tilt: tuple[float, float] = (0.0, 0.0)
    """Turns of the table's axis about east and north, rad."""
    positions: Array | None = None
    """(m, 3) where every sensor sits, m, block axes from the turn axis; None for all on it. Any other needs a ramp."""


@dataclass(frozen=True)
class Imperfections:
    """Noise of the sensors and the table."""

    accelerometer: float = 5e-6 * STANDARD_GRAVITY
    """Density of white noise, m/s²/√Hz (5 µg/√Hz unless given)."""
    gyro: float = 0.001 * ARCSEC * 60
    """Density of white noise, rad/s/√Hz (0.001 °/√h unless given)."""
    sway: float = 0.0
    """One sigma of the base's velocity at the end of a row, per axis, m/s."""
    wobble: float = 0.0
    """One sigma of the turn axis' direction from stop to stop, per axis, rad."""
    table: float = 0.0
    """One sigma of the table's angle at a stop, rad."""


def triads(axes: Array | None = None) -> tuple[Sensor, ...]:
    """Accelerometers A1… and gyros G1… along axes (m, 3), unit vectors; x, y, z unless given. Readings in SI."""
    directions = np.eye(3) if axes is None else axes
    made = [
        Sensor(f"{letter}{i + 1}", kind, axis, 1.0, unit)
        for letter, kind, unit in (("A", ACCELEROMETER, "m/s2"), ("G", GYROSCOPE, "rad/s"))
        for i, axis in enumerate(directions)
    ]
    return tuple(made)


def table_angle(programme: TurntableProgramme) -> tuple[Array, Array]:
    """(R + 1,) angle of the table, rad, at the ends of rows, from time 0 on, and places (R + 1,) between the stops."""
    angle, course = [], []
    for number, target in enumerate(programme.angles):
        if number:
            before = programme.angles[number - 1]
            part = turned_part(abs(target - before), programme)
            angle.append(before + part * (target - before))
            course.append(number - 1 + part)
        rows = round(programme.dwell / programme.row) + 1
        angle.append(np.full(rows, target))
        course.append(np.full(rows, float(number)))
    return np.concatenate(angle), np.concatenate(course)


def turned_part(turn: float, programme: TurntableProgramme) -> Array:
    """(r,) part of a turn by ``turn``, rad, done at the ends of its rows but the last, dimensionless."""
    ramp = round(programme.ramp / programme.row)
    rows = max(round(turn / programme.rate / programme.row), 1) + ramp
    steps_to_end = np.minimum(np.arange(rows + 1), np.arange(rows + 1)[::-1])
    rate = np.minimum(steps_to_end / ramp, 1.0) if ramp else np.ones(rows + 1)
    done = np.cumsum(0.5 * (rate[1:] + rate[:-1]))
    return np.asarray(done[:-1] / done[-1])


def turn_rates(angle: Array, row: float) -> Array:
    """(R + 1,) rate of the table, rad/s, at the ends of rows of ``row`` s, from its angle (R + 1,), rad.

    Of a rate that changes evenly within every row, from rest: w_j = 2 Δθ_j/row − w_{j−1}.
    """
    mean = np.diff(angle) / row
    sign = (-1.0) ** np.arange(len(mean))
    return np.concatenate([[0.0], sign * np.cumsum(2 * sign * mean)])


def at_a_distance(sensors: tuple[Sensor, ...], positions: Array, rate: Array, row: float) -> Array:
    """(R, m) inputs from the turn to sensors at positions (m, 3), m, in m/s²: means of a·(ω×(ω×r) + α×r) over each row.

    rate : (R + 1,) of the table at the ends of rows of ``row`` s, rad/s, evenly changing in between.
    """
    square = (rate[1:] ** 2 + rate[1:] * rate[:-1] + rate[:-1] ** 2) / 3
    axes = np.stack([sensor.nominal_axis for sensor in sensors])
    felt = np.column_stack([-square, np.diff(rate) / row]) @ coefficients(axes, positions).T
    return np.asarray(felt * [sensor.kind == ACCELEROMETER for sensor in sensors])


def true_attitude(programme: TurntableProgramme, truth: Truth, leaning: Array) -> Array:
    """(R + 1, 3, 3) C at the ends of rows, dimensionless; leaning (stops, 2) tilts the turn axis at every stop, rad."""
    angle, course = table_angle(programme)
    lean = np.stack([np.interp(course, np.arange(len(leaning)), column) for column in leaning.T], axis=1)
    level = Rotation.from_rotvec([*truth.tilt, 0.0]) * Rotation.from_rotvec([0.0, 0.0, truth.heading])
    wobble = Rotation.from_rotvec(np.column_stack([lean, np.zeros(len(lean))]))
    turn = Rotation.from_rotvec(angle[:, None] * [0.0, 0.0, 1.0])
    return np.asarray((level * wobble * turn).as_matrix())


def true_motion(attitude: Array, row: float, latitude: float, g: float) -> BlockMotion:
    """The true motion of the block in rows of ``row`` s.

    attitude : (R + 1, 3, 3) C at the ends of the rows, dimensionless; latitude in rad, g in m/s².
    """
    time = row * np.arange(len(attitude))
    inertial = Rotation.from_rotvec(time[:, None] * earth_rate(latitude)) * Rotation.from_matrix(attitude)
    steps = (inertial[:-1].inv() * inertial[1:]).as_rotvec()
    half_earth = Rotation.from_rotvec(0.5 * row * earth_rate(latitude))
    middle = half_earth * Rotation.from_matrix(attitude[1:]) * Rotation.from_rotvec(-0.5 * steps)
    return BlockMotion(np.asarray(steps / row), np.asarray(middle.inv().apply([0.0, 0.0, g])), row)


def simulate_alignment(
    sensors: tuple[Sensor, ...],
    site: Site,
    programme: TurntableProgramme,
    truth: Truth,
    rng: np.random.Generator,
    *,
    imperfections: Imperfections | None = None,
    unit: str = "simulated",
) -> tuple[CalibrationSession, Array]:
    """A rotation-alignment session, and the true attitude C (R, 3, 3), dimensionless, at the end of every row.

    Errors of ``truth`` are those of the block's axes; the noise is every sensor's own.
    """
    noise = imperfections or Imperfections()
    assert site.latitude is not None
    leaning = noise.wobble * rng.standard_normal((len(programme.angles), 2))
    attitude = true_attitude(programme, truth, leaning)
    motion = true_motion(attitude, programme.row, site.latitude, gravity(site))
    rows = len(motion.rates)
    velocity = noise.sway * np.vstack([np.zeros(3), rng.standard_normal((rows, 3))])
    swayed = motion.forces + np.einsum("rji,rj->ri", attitude[1:], np.diff(velocity, axis=0) / programme.row)
    angle, course = table_angle(programme)
    misread = np.interp(course, np.arange(len(leaning)), noise.table * rng.standard_normal(len(leaning)))
    readings = _readings(sensors, with_errors(replace(motion, forces=swayed), truth), noise, rng)
    if truth.positions is not None:
        rate = turn_rates(angle, programme.row)
        felt = at_a_distance(sensors, truth.positions, rate, programme.row)
        readings = readings + np.array([sensor.nominal_scale for sensor in sensors]) * felt
    session = CalibrationSession(
        unit=unit,
        block=GYROSCOPE,
        programme=ROTATION_ALIGNMENT,
        sensors=sensors,
        readings=readings,
        standard_errors=np.full((rows, len(sensors)), np.nan),
        site=site,
        stand=Stand("turntable", sigma=StandErrors(beta=noise.table, wobble=noise.wobble or None)),
        time=programme.row * np.arange(1, rows + 1),
        turn_angle=angle[1:] + misread[1:],
    )
    return session, attitude[1:]


def with_errors(motion: BlockMotion, truth: Truth) -> BlockMotion:
    """The block's axes without noise: f + ∇, and ω + ε + (E_xz, E_yz, κ)·ω_z."""
    rates = motion.rates + truth.gyro_bias + motion.rates[:, 2:] * np.array([*truth.mounting, truth.kappa])
    return replace(motion, rates=rates, forces=motion.forces + truth.accelerometer_bias)


def _readings(
    sensors: tuple[Sensor, ...], motion: BlockMotion, noise: Imperfections, rng: np.random.Generator
) -> Array:
    """(R, m) readings of the sensors along their axes, reading units."""
    columns = []
    for sensor in sensors:
        accelerometer = sensor.kind == ACCELEROMETER
        inputs, density = (motion.forces, noise.accelerometer) if accelerometer else (motion.rates, noise.gyro)
        values = inputs @ sensor.nominal_axis + density / np.sqrt(motion.row) * rng.standard_normal(len(inputs))
        columns.append(sensor.nominal_scale * values + (sensor.nominal_offset or 0.0))
    return np.column_stack(columns)


def simulate_rate_table(
    sensors: tuple[Sensor, ...],
    site: Site,
    runs: tuple[tuple[float, float], ...],
    truth: Truth,
    rng: np.random.Generator,
    *,
    row: float = 0.1,
    imperfections: Imperfections | None = None,
    unit: str = "simulated",
) -> CalibrationSession:
    """A rate-table session; ``runs`` holds rate (rad/s) and duration (s) of each run in order."""
    assert site.latitude is not None
    rate = np.concatenate([np.full(round(time / row), speed) for speed, time in runs])
    angle = np.concatenate([[0.0], np.cumsum(rate * row)])
    level = Rotation.from_rotvec([*truth.tilt, 0.0]) * Rotation.from_rotvec([0.0, 0.0, truth.heading])
    attitude = (level * Rotation.from_rotvec(angle[:, None] * [0.0, 0.0, 1.0])).as_matrix()
    motion = true_motion(attitude, row, site.latitude, gravity(site))
    gyros = tuple(replace(sensor) for sensor in sensors if sensor.kind == GYROSCOPE)
    return CalibrationSession(
        unit=unit,
        block=GYROSCOPE,
        programme=RATE_TABLE,
        sensors=gyros,
        readings=_readings(gyros, with_errors(motion, truth), imperfections or Imperfections(), rng),
        standard_errors=np.full((len(rate), len(gyros)), np.nan),
        site=site,
        stand=Stand("rate table"),
        time=row * np.arange(1, len(rate) + 1),
        turn_rate=rate,
    )
