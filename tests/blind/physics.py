"""The vectors that the stand applies and the readings of the sensors: the equations, one after another."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from tests.blind.effects_grammar import GRAMMAR
from tests.blind.effects_outside import OUTSIDE_INPUT, OUTSIDE_POSE
from tests.blind.effects_pose import POSE
from tests.blind.effects_sensor import INPUT, UNIT, clipped
from tests.blind.pose import Pose, believed, gravity
from tests.blind.world import EARTH_RATE, Array, Effect, Session

HELD = POSE | OUTSIDE_POSE
ADDED = INPUT | OUTSIDE_INPUT | GRAMMAR


@dataclass(frozen=True, eq=False)
class StandErrors:
    """The stand's errors of one session as they happened, rad; beta (R,)."""

    theta_x: float
    theta_y: float
    alpha: float
    beta: Array


def draw_errors(session: Session, rng: np.random.Generator) -> StandErrors:
    """Errors drawn from the stated sigmas."""
    s = session.stand.sigma
    x, y, alpha = (rng.normal(0, sigma) for sigma in (s.theta_x, s.theta_y, s.alpha))
    return StandErrors(x, y, alpha, rng.normal(0, s.beta, session.schedule.rows))


def direction(elevation: Array, beta: Array, across: Array) -> Array:
    """(R, 3) up in platform axes, dimensionless: tilted about the level Y axis, raised by the head, turned by β.

    ``elevation``, ``beta`` and ``across`` (the tilt), each (R,), rad.
    """
    up = np.stack([across, np.zeros_like(across), np.ones_like(across)]) / np.hypot(across, 1.0)
    y = np.sin(elevation) * up[2]
    z = np.cos(elevation) * up[2]
    return np.stack([np.cos(beta) * up[0] - np.sin(beta) * z, y, np.sin(beta) * up[0] + np.cos(beta) * z], axis=1)


def reference_vectors(session: Session, pose: Pose) -> tuple[Array, Array]:
    """Specific force (R, 3), m/s², and Earth rate (R, 3), rad/s, in block axes."""
    phi = session.site.latitude
    force = gravity(session.site) * pose.gravity_factor * direction(pose.alpha, pose.beta, pose.theta_y)
    across = np.sin(phi) * pose.theta_y + np.cos(phi) * pose.meridian
    rate = EARTH_RATE * direction(pose.chi, pose.beta, across)
    turned = []
    for platform in (force, rate):
        flipped = platform * np.array([-1.0, -1.0, 1.0])
        block = np.where(pose.flipped[:, None], flipped, platform) @ session.mounting.T
        turned.append(Rotation.from_rotvec(-pose.turn).apply(block) if pose.turn.any() else block)
    return turned[0], turned[1]


def with_errors(pose: Pose, errors: StandErrors | None) -> Pose:
    """The pose as the stand's random errors leave it."""
    if errors is None:
        return pose
    raised = errors.theta_x + errors.alpha
    return pose.moved(alpha=raised, chi=raised, theta_y=errors.theta_y, beta=errors.beta)


def true_input(session: Session, effects: Sequence[Effect] = (), errors: StandErrors | None = None) -> Array:
    """(R, m) a + b + c·a² + every hidden term, at the input, m/s² or rad/s."""
    unit = session.unit
    pose = with_errors(believed(session), errors)
    for effect in effects:
        pose = HELD[effect.cause](session, effect, pose) if effect.cause in HELD else pose
        unit = UNIT[effect.cause](unit, effect) if effect.cause in UNIT else unit
    force, rate = reference_vectors(session, pose)
    n = np.where(unit.gyro[:, None], rate[:, None, :], force[:, None, :])
    a = np.einsum("rmk,mk->rm", n, unit.axis)
    x = a + unit.bias + unit.quadratic * a**2
    for effect in effects:
        if effect.cause in ADDED:
            x[:, effect.sensor] += ADDED[effect.cause](session, effect, n[:, effect.sensor], a[:, effect.sensor], force)
    return x


def scale_of(session: Session, effects: Sequence[Effect]) -> Array:
    """(m,) true scale, reading units per m/s² or rad/s, the drift of a sensor included."""
    unit = session.unit
    for effect in effects:
        unit = UNIT[effect.cause](unit, effect) if effect.cause in UNIT else unit
    return unit.scale


def mean_readings(session: Session, effects: Sequence[Effect] = (), errors: StandErrors | None = None) -> Array:
    """(R, m) readings without noise, reading units."""
    u = scale_of(session, effects) * true_input(session, effects, errors)
    return recorded(clipped(u, effects), effects)


def recorded(u: Array, effects: Sequence[Effect]) -> Array:
    """Readings (R, m) as they were written down, reading units: columns exchanged, signs turned."""
    u = u.copy()
    for effect in effects:
        if effect.cause == "channels-swapped":
            i, k = effect.sensors
            u[:, [i, k]] = u[:, [k, i]]
        if effect.cause == "sign-reversed":
            u[:, effect.sensor] *= -1
    return u


def measure(session: Session, effects: Sequence[Effect], rng: np.random.Generator) -> tuple[Array, StandErrors]:
    """(R, m) readings as the file holds them, reading units, and the stand's errors that went into them."""
    errors = draw_errors(session, rng)
    scale = scale_of(session, effects)
    x = true_input(session, effects, errors)
    wander = session.noise.repeatability * rng.standard_normal(x.shape)
    for effect in effects:
        if effect.cause == "excess-noise":
            wander[:, effect.sensor] += effect.k * rng.standard_normal(len(x))
    u = scale * (x + wander + before_counting(session) * rng.standard_normal(x.shape))
    if session.count_time is not None:
        u = np.where(session.unit.gyro, np.round(u), u)
    return recorded(clipped(u, effects), effects), errors


def before_counting(session: Session) -> Array:
    """(m,) stated noise at the input, m/s² or rad/s, without the share that counting whole pulses adds."""
    counted = session.unit.gyro & (session.count_time is not None)
    share = np.where(counted, 1 / 12, 0.0) / session.unit.scale**2
    return np.sqrt(session.noise.reading**2 - share)
