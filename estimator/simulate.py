"""Sessions whose truth is known: the forward model on a stand with errors, and noise from an rng."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import EARTH_RATE, elevation, magnitude, stand_vector, to_block
from estimator.arrays import tangents, unit
from estimator.forward import response
from estimator.parameters import SensorParameters, nominal
from estimator.session import (
    ACCELEROMETER,
    ARBITRARY_ORIENTATIONS,
    RESET,
    TWO_AXIS_STAND,
    Array,
    CalibrationSession,
    Sensor,
    Site,
    Stand,
    StandErrors,
)


def cone(m: int, half_angle: float, axis: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> Array:
    """(m, 3) input axes, unit vectors, evenly spaced on a cone about ``axis``; half angle in rad."""
    centre = unit(np.array(axis, dtype=float))
    side = tangents(centre)
    turn = 2 * np.pi * np.arange(m) / m
    around = np.cos(turn)[:, None] * side[:, 0] + np.sin(turn)[:, None] * side[:, 1]
    return np.asarray(np.cos(half_angle) * centre + np.sin(half_angle) * around)


def stand_schedule(
    sensors: tuple[Sensor, ...],
    stand: Stand,
    site: Site,
    positions: int,
    *,
    unit_name: str = "simulated",
    runs: tuple[bool, ...] = (False, True),
    period: float = 120.0,
    mounting: Array | None = None,
    count_time: float | None = None,
) -> CalibrationSession:
    """A two-axis-stand session still to be measured: equal β steps in each run, readings zero.

    ``runs`` lists the runs in order, True for flipped; ``period`` is the time between rows, s; ``mounting`` (3, 3) is
    the rotation platform → block, none unless given; ``count_time`` in s for pulse gyros.
    """
    beta = np.tile(2 * np.pi * np.arange(positions) / positions, len(runs))
    empty = np.zeros((len(beta), len(sensors)))
    return CalibrationSession(
        unit=unit_name,
        block=sensors[0].kind,
        programme=TWO_AXIS_STAND,
        sensors=sensors,
        readings=empty,
        standard_errors=empty,
        site=site,
        stand=stand,
        mounting=np.eye(3) if mounting is None else mounting,
        flipped=np.repeat(np.array(runs), positions),
        beta=beta,
        time=period * np.arange(len(beta)),
        count_time=count_time,
    )


@dataclass(frozen=True, eq=False)
class StandDraw:
    """The stand's errors of one session as they happened."""

    constant: StandErrors
    """Errors in rad (s); ``beta`` unused."""
    beta: Array
    """(R,) rad."""


def draw_stand(session: CalibrationSession, rng: np.random.Generator) -> StandDraw:
    """Stand errors drawn from the stated sigmas."""
    assert session.stand is not None
    assert session.beta is not None
    s = session.stand.sigma
    drawn = StandErrors(
        theta_x=rng.normal(0, s.theta_x),
        theta_y=rng.normal(0, s.theta_y),
        alpha=rng.normal(0, s.alpha),
        latitude=rng.normal(0, s.latitude),
        meridian=rng.normal(0, s.meridian),
        count_time=rng.normal(0, s.count_time),
    )
    return StandDraw(drawn, rng.normal(0, s.beta, len(session.beta)))


def true_vectors(session: CalibrationSession, draw: StandDraw) -> Array:
    """(R, m, 3) vectors that the stand really applied, exact in its errors, m/s² (rad/s), block axes."""
    assert session.stand is not None
    assert session.beta is not None
    phi, e = session.site.latitude or 0.0, draw.constant
    applied = {}
    for kind in {s.kind for s in session.sensors}:
        errors = e
        if kind != ACCELEROMETER:
            level = e.theta_y * np.sin(phi) + e.meridian * np.cos(phi)
            errors = replace(e, theta_y=level, alpha=e.alpha + e.latitude)
        platform = stand_vector(elevation(session.stand, kind), session.beta + draw.beta, errors)
        applied[kind] = magnitude(session, kind) * to_block(platform, session)
    return np.stack([applied[s.kind] for s in session.sensors], axis=1)


def simulate(
    schedule: CalibrationSession,
    truth: SensorParameters,
    rng: np.random.Generator,
    *,
    noise: Array | float,
    draw: StandDraw | None = None,
    state_noise: bool = True,
) -> CalibrationSession:
    """A measured session of known truth.

    Parameters
    ----------
    schedule : what is to be measured (`stand_schedule`, `orientation_schedule`); its readings are ignored.
    truth : (m,) the sensors' true parameters.
    rng : the only source of chance.
    noise : one sigma of an averaged reading, reading units; scalar or (m,).
    draw : the stand's errors; drawn from the stated sigmas when None.
    state_noise : whether the session states ``noise`` as its standard errors.

    Returns
    -------
    The session with readings; pulse gyros are counted in whole pulses.
    """
    return whole_pulses(uncounted(schedule, truth, rng, noise=noise, draw=draw, state_noise=state_noise))


def uncounted(
    schedule: CalibrationSession,
    truth: SensorParameters,
    rng: np.random.Generator,
    *,
    noise: Array | float,
    draw: StandDraw | None = None,
    state_noise: bool = True,
) -> CalibrationSession:
    """The session of `simulate` before its pulses are counted: what is added to its readings is counted with them."""
    shape = schedule.readings.shape
    if schedule.programme == TWO_AXIS_STAND:
        drawn = draw or draw_stand(schedule, rng)
        n, lasted = true_vectors(schedule, drawn), drawn.constant.count_time
    else:
        n, lasted = orientation_vectors(schedule, rng), 0.0
    repeatability = np.array([s.bias_repeatability for s in schedule.sensors])
    clean = response(truth, n) + truth.scale * repeatability * rng.standard_normal(shape)
    sigma = np.broadcast_to(np.asarray(noise, dtype=float), shape)
    readings = counter_output(clean, schedule, lasted, sigma * rng.standard_normal(shape), rng)
    offset = np.array([s.nominal_offset or 0.0 for s in schedule.sensors])
    stated = sigma if state_noise else np.full(shape, np.nan)
    known = schedule.directions if schedule.direction_sigma is not None else None
    return replace(schedule, readings=readings + offset, standard_errors=np.array(stated), directions=known)


def counter_output(
    clean: Array, schedule: CalibrationSession, lasted: float, error: Array, rng: np.random.Generator
) -> Array:
    """(R, m) readings from noiseless ones and their errors (R, m): of pulse gyros how far the counter comes, the rest
    as they are.

    A counter that runs on begins anywhere between two pulses.

    All in reading units, ``clean`` of a pulse gyro in pulses per s. ``lasted`` is by how much the count time exceeds
    the stated one, s.
    """
    if schedule.count_time is None:
        return clean + error
    begun = 0.0 if schedule.counter == RESET else rng.uniform(-0.5, 0.5, clean.shape)
    pulses = clean * (schedule.count_time + lasted) + error + begun
    return np.where(counts_pulses(schedule), pulses, clean + error)


def counts_pulses(session: CalibrationSession) -> NDArray[np.bool_]:
    """(m,) the sensors whose pulses the session counts."""
    return np.array([session.count_time is not None and s.kind != ACCELEROMETER for s in session.sensors])


def whole_pulses(session: CalibrationSession) -> CalibrationSession:
    """The session as a counter gives it: pulses whole, all other readings as they are."""
    pulses = counts_pulses(session)
    return replace(session, readings=np.where(pulses, np.round(session.readings), session.readings))


def orientation_vectors(schedule: CalibrationSession, rng: np.random.Generator) -> Array:
    """(R, m, 3) vectors applied in still orientations, m/s² (rad/s): gravity, to gyros the Earth's rate at a random
    heading.
    """
    assert schedule.directions is not None
    up, phi = schedule.directions, schedule.site.latitude or 0.0
    heading = rng.uniform(0, 2 * np.pi, len(up))
    north = (tangents(up) @ np.stack([np.cos(heading), np.sin(heading)], axis=-1)[..., None])[..., 0]
    force = magnitude(schedule, ACCELEROMETER) * up
    rate = EARTH_RATE * (np.sin(phi) * up + np.cos(phi) * north)
    return np.stack([force if s.kind == ACCELEROMETER else rate for s in schedule.sensors], axis=1)


def orientation_schedule(
    sensors: tuple[Sensor, ...], site: Site, directions: Array, *, unit_name: str = "simulated"
) -> CalibrationSession:
    """Still orientations to be measured: directions (R, 3) of the specific force, any length, block axes.

    The directions serve the simulation; the session does not state them.
    """
    empty = np.zeros((len(directions), len(sensors)))
    return CalibrationSession(
        unit=unit_name,
        block=sensors[0].kind,
        programme=ARBITRARY_ORIENTATIONS,
        sensors=sensors,
        readings=empty,
        standard_errors=empty,
        site=site,
        directions=unit(directions),
    )


def scattered(
    sensors: tuple[Sensor, ...],
    norm: Array,
    rng: np.random.Generator,
    *,
    scale: float = 1e-3,
    bias: float = 1e-3,
    quadratic: float = 1e-5,
    axis: float = 1e-3,
) -> SensorParameters:
    """True parameters scattered about the nominal ones; one sigmas dimensionless (relative, g, 1/g, rad).

    norm : (m,) length of the applied vector, m/s² (rad/s).
    """
    step = rng.standard_normal((len(sensors), 5)) * np.array([scale, bias, quadratic, axis, axis])
    return nominal(sensors).stepped(step, norm)
