"""Pairs of sessions between which the block was turned, simulated apart from the estimator (`tests.blind`).

On a stand: exact physics with the stand's errors. In arbitrary orientations: still positions anyhow, read by the
sensors' equation; the block's frame is then its own, unless the directions of gravity are stated in its fixture's.
Noise is small, a microradian of the applied vector, so that what is second order in a turn would show.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from tests.blind.case import effect_columns
from tests.blind.draw import DEGREE, Arrangement, draw_mounting, draw_site, draw_stand, draw_unit
from tests.blind.effects_sensor import UNIT, across
from tests.blind.hide import at_strength, draw_effect
from tests.blind.physics import measure
from tests.blind.pose import gravity
from tests.blind.schedule import Wanted, draw_schedule
from tests.blind.strength import Lens, history_information, root
from tests.blind.world import EARTH_RATE, STANDARD_G, Array, Effect, Noise, Session, StandSigma, Unit
from tests.blind.write import session_file

READING = 1e-6
"""Noise of a reading, part of the applied vector."""
STEADY = 0.02
"""Part of a drawn stand's errors that is left: 0.01 to 0.1 arcsec."""
STATED = 1e-3 * DEGREE
"""Sigma of stated directions, rad."""
ORIENTATIONS = 24


@dataclass(frozen=True)
class Programme:
    """A programme to measure."""

    name: str
    accelerometers: int = 0
    gyros: int = 0
    triads: bool = False
    stand: bool = True
    stated: bool = False
    """Whether the directions of gravity are stated in the axes of the fixture."""

    @property
    def shows_a_turn(self) -> bool:
        """Whether a common turn shows."""
        return self.stand or self.stated


PROGRAMMES = (
    Programme("stand, 4 accelerometers", accelerometers=4),
    Programme("stand, 6 accelerometers", accelerometers=6),
    Programme("stand, 6 gyros", gyros=6),
    Programme("stand, 4 triads", accelerometers=12, triads=True),
    Programme("orientations, 6 accelerometers", accelerometers=6, stand=False),
    Programme("orientations, 2 triads", accelerometers=6, triads=True, stand=False),
    Programme("stated directions, 6 accelerometers", accelerometers=6, stand=False, stated=True),
)


@dataclass(frozen=True)
class Wish:
    """Wished content of a pair."""

    programme: Programme
    degrees: float
    earlier: int = 1
    """Sessions before, every one in a mounting of its own."""
    drift: float = 0.0
    """Strength of a drift of one sensor, standard errors beside the turn; 0 for none."""


@dataclass(frozen=True, eq=False)
class Pair:
    """A session and those before it, and the truth."""

    session: dict[str, Any]
    history: list[dict[str, Any]]
    turn: Array
    """(3,) rotation vector since the latest, rad."""
    drifted: str | None


def draw_pair(wish: Wish, rng: np.random.Generator) -> Pair:
    """Drawn at random."""
    world = _session(wish.programme, rng)
    turns = [_turn(wish.degrees, rng) for _ in range(wish.earlier)]
    since = turns[-1]
    mounts = [Rotation.from_rotvec(since) * Rotation.from_rotvec(-t) for t in turns[:-1]]
    mounts = [*mounts, Rotation.identity(), Rotation.from_rotvec(since)]
    drift = _drift(wish, world, rng) if wish.drift else None
    worlds = [replace(world, schedule=_schedule(rng)) for _ in mounts[:-1]]
    files = [_file(wish.programme, w, m, None, rng) for w, m in zip(worlds, mounts[:-1], strict=True)]
    now = _file(wish.programme, world, mounts[-1], drift, rng)
    return Pair(now, files, since, None if drift is None else world.unit.names[drift.sensor])


def draw_flipped(programme: Programme, degrees: float, rng: np.random.Generator) -> Pair:
    """A session on a stand, alone, with the block turned in its flipped run against the direct one."""
    world, turn = _session(programme, rng), _turn(degrees, rng)
    readings = measure(world, [Effect("flip-misalignment", tuple(turn))], rng)[0]
    return Pair(session_file(world, readings), [], turn, None)


def _turn(degrees: float, rng: np.random.Generator) -> Array:
    axis = rng.standard_normal(3)
    return np.asarray(np.radians(degrees) * axis / np.linalg.norm(axis))


def _session(programme: Programme, rng: np.random.Generator) -> Session:
    unit = draw_unit(Arrangement(programme.accelerometers, programme.gyros), rng)
    unit = _as_triads(unit, rng) if programme.triads else unit
    site, size = draw_site(rng), np.where(unit.gyro, EARTH_RATE, STANDARD_G)
    stand = draw_stand(site, rng)
    s = stand.sigma
    sigma = StandSigma(STEADY * s.theta_x, STEADY * s.theta_y, STEADY * s.alpha, STEADY * s.beta)
    noise = Noise(READING * size * rng.uniform(0.7, 1.4, unit.size), np.zeros(unit.size))
    return Session(unit, _schedule(rng), site, replace(stand, sigma=sigma), draw_mounting(rng), noise)


def _schedule(rng: np.random.Generator) -> Any:
    wanted = Wanted(int(rng.integers(10, 17)), (False, True), rng.random() < 0.7, False, "constant", True, False)
    return draw_schedule(wanted, rng)


def _as_triads(unit: Unit, rng: np.random.Generator) -> Unit:
    """Three sensors at right angles, and three, each triad mounted anyhow; each axis half a degree off."""
    triads = Rotation.random(unit.size // 3, random_state=rng).as_matrix()
    nominal = triads.transpose(0, 2, 1).reshape(-1, 3)
    off = [e + 0.004 * (across(e)[0] * rng.standard_normal() + across(e)[1] * rng.standard_normal()) for e in nominal]
    axis = np.array(off) / np.linalg.norm(off, axis=1, keepdims=True)
    return replace(unit, nominal_axis=nominal, axis=axis)


def _file(
    programme: Programme, world: Session, mount: Rotation, drift: Effect | None, rng: np.random.Generator
) -> dict[str, Any]:
    """A session file; the block sits turned by ``mount``."""
    effects = [] if drift is None else [drift]
    turn = Effect("remount-rotation", tuple(mount.as_rotvec()))
    if programme.stand:
        return session_file(world, measure(world, [turn, *effects], rng)[0])
    return _still(programme, _drifted(world.unit, drift), world, mount, rng)


def _drifted(unit: Unit, drift: Effect | None) -> Unit:
    return unit if drift is None else UNIT[drift.cause](unit, drift)


def _still(
    programme: Programme, unit: Unit, world: Session, mount: Rotation, rng: np.random.Generator
) -> dict[str, Any]:
    """Still positions; directions stated in the fixture's axes, where they are."""
    up = rng.standard_normal((ORIENTATIONS, 3))
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    noise, g = world.noise.reading, gravity(world.site)
    a = g * mount.inv().apply(up) @ unit.axis.T
    u = unit.scale * (a + unit.bias + unit.quadratic * a**2 + noise * rng.standard_normal(a.shape))
    table: dict[str, Any] = {name: u[:, i].tolist() for i, name in enumerate(unit.names)}
    table |= {f"{name}_se": [float(world.unit.scale[i] * noise[i])] * len(up) for i, name in enumerate(unit.names)}
    document = session_file(world, np.zeros((world.schedule.rows, unit.size)))
    document |= {"programme": "arbitrary-orientations", "table": table, "site": {"gravity_m_s2": g}}
    if programme.stated:
        seen = up + STATED * rng.standard_normal(up.shape)
        seen /= np.linalg.norm(seen, axis=1, keepdims=True)
        table |= {f"direction_{axis}": seen[:, k].tolist() for k, axis in enumerate("xyz")}
        document["direction_sigma_deg"] = STATED / DEGREE
    return {key: value for key, value in document.items() if key not in ("stand", "mounting")}


def _drift(wish: Wish, world: Session, rng: np.random.Generator) -> Effect:
    """A drift of one sensor, as strong as wished beside a turn of the block that is left open."""
    if not wish.programme.stand:
        return _drift_at_rest(wish, world, rng)
    free = effect_columns(world, Effect("remount-rotation", (1e-4, 1e-4, 1e-4)))
    lens = Lens(world, root(history_information([world] * wish.earlier))).without(free)
    return at_strength(lens, draw_effect(world, "sensor-drift", rng), wish.drift)[0]


def _drift_at_rest(wish: Wish, world: Session, rng: np.random.Generator) -> Effect:
    """A drift of one sensor, as strong as wished, in arbitrary orientations, both sessions like one drawn here; the
    common turn of the axes left open.
    """
    up = rng.standard_normal((ORIENTATIONS, 3))
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    told = _information(world, up, STATED if wish.programme.stated else np.inf)
    effect = draw_effect(world, "sensor-drift", rng)
    step = np.zeros((world.unit.size, 5))
    step[effect.sensor, [0, 1, 3, 4]] = effect.amplitude
    change = told @ step.ravel()
    e = world.unit.axis
    turn = np.zeros((world.unit.size, 5, 3))
    for i, axis in enumerate(e):
        turn[i, 3:] = np.cross(axis, np.stack(across(axis)))
    free = turn.reshape(-1, 3)
    fixed = np.linalg.pinv(free.T @ told @ free, hermitian=True)
    square = step.ravel() @ change - (free.T @ change) @ fixed @ (free.T @ change)
    shared = wish.earlier / (1 + wish.earlier)
    return replace(effect, amplitude=tuple(np.array(effect.amplitude) * wish.drift / np.sqrt(shared * square)))


def _information(world: Session, up: Array, sigma: float) -> Array:
    """(5m, 5m) on relative scale, bias, quadratic and both turns of the axes, the directions left open or stated."""
    unit, g = world.unit, gravity(world.site)
    m, a = unit.size, g * up @ unit.axis.T
    sides = np.array([across(e) for e in unit.axis])
    own = np.stack([a, 1 + 0 * a, a**2, *(g * up @ sides[:, k].T for k in (0, 1))], axis=-1)
    told = np.zeros((5 * m, 5 * m))
    for j, n in enumerate(up):
        columns = np.zeros((m, 5 * m))
        for i in range(m):
            columns[i, 5 * i : 5 * i + 5] = own[j, i] / world.noise.reading[i]
        swing = g * unit.axis @ np.stack(across(n), axis=1) / world.noise.reading[:, None]
        inner = np.linalg.inv(swing.T @ swing + np.eye(2) / sigma**2)
        told += columns.T @ (np.eye(m) - swing @ inner @ swing.T) @ columns
    return told
