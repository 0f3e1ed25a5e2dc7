"""Zeros of several sensors that step at one row of a session: a bump, a power glitch, a block seated anew."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.blind.draw import Arrangement, draw_mounting, draw_noise, draw_site, draw_stand, draw_unit
from tests.blind.effects_sensor import across
from tests.blind.physics import measure, reference_vectors
from tests.blind.pose import believed, gravity
from tests.blind.schedule import Wanted, draw_schedule
from tests.blind.strength import Lens, orthonormal
from tests.blind.world import Array, Noise, Session
from tests.blind.write import session_file

ORIENTATIONS = 24
SAFE = 4
"""Rows before and after a step at least: fewer hardly tell it from a reading or two far off."""
SHOWN = 0.4
"""Share of a step that the calibration must leave: one between the runs of a stand is taken for a turn of the axes."""


@dataclass(frozen=True)
class Block:
    """Block and programme to measure."""

    name: str
    accelerometers: int = 0
    gyros: int = 0
    stand: bool = True


BLOCKS = (
    Block("stand, 6 accelerometers", accelerometers=6),
    Block("stand, 6 gyros", gyros=6),
    Block("orientations, 6 accelerometers", accelerometers=6, stand=False),
    Block("orientations, 12 accelerometers", accelerometers=12, stand=False),
)


@dataclass(frozen=True, eq=False)
class Stepped:
    """A session file and what is true of it."""

    session: dict[str, Any]
    sensors: tuple[str, ...]
    rows: tuple[int, ...]
    """The first after the step of every one of the sensors, counted from 1."""
    size: tuple[float, ...]
    """Step of every one of the sensors, m/s² or rad/s."""


def draw_steps(block: Block, strengths: Array, rng: np.random.Generator, *, apart: bool = False) -> Stepped:
    """A session in which so many sensors step by ``strengths`` (k,) standard errors each; ``apart``: each at a row of
    its own.
    """
    world, up = session_of(block, rng), directions(rng)
    rows, m = world.schedule.rows if block.stand else ORIENTATIONS, world.unit.size
    sensors = np.sort(rng.choice(m, len(strengths), replace=False))
    after = (np.arange(rows)[:, None] >= np.arange(rows)) * 1.0
    seen = np.array([strength_left(block, world, up, i, after) for i in range(m)])
    alone = np.array([_strength_alone(world, i, after) for i in range(m)])
    able = np.flatnonzero((seen > SHOWN * alone).all(axis=0))
    able = able[(able >= SAFE) & (able <= rows - SAFE)]
    if len(able) < (len(strengths) if apart else 1):
        return draw_steps(block, strengths, rng, apart=apart)
    row = rng.choice(able, len(sensors), replace=False) if apart else np.full(len(sensors), rng.choice(able))
    size = rng.choice([-1.0, 1.0], len(sensors)) * strengths / seen[sensors, row]
    added = np.zeros((rows, m))
    added[:, sensors] = after[:, row] * size
    names = tuple(world.unit.names[i] for i in sensors)
    return Stepped(steps_file(block, world, up, added, rng), names, tuple((row + 1).tolist()), tuple(size.tolist()))


def draw_others(block: Block, kind: str, strength: float, rng: np.random.Generator) -> Stepped:
    """An effect that resembles a step of all zeros, of so many standard errors: ``kind`` of `OTHERS`."""
    world, up = session_of(block, rng), directions(rng)
    rows, m = world.schedule.rows if block.stand else ORIENTATIONS, world.unit.size
    added = OTHERS[kind](world, rows, rng)
    common = kind == TURNED
    for own in (range(m),) if common else ((i,) for i in range(m)):
        columns = np.zeros((rows, m, 1))
        columns[:, list(own), 0] = added[:, list(own)]
        added[:, list(own)] *= strength / float(_left(block, world, up, columns)[0])
    return Stepped(steps_file(block, world, up, added, rng), tuple(world.unit.names), (), ())


def _walks(world: Session, rows: int, rng: np.random.Generator) -> Array:
    """(R, m) every zero walks by itself."""
    return np.cumsum(rng.standard_normal((rows, world.unit.size)), axis=0)


def _ramps(world: Session, rows: int, rng: np.random.Generator) -> Array:
    """(R, m) every zero begins to drift at a row of its own."""
    m = world.unit.size
    begun = rng.integers(0, rows - SAFE, m)
    return np.maximum(np.arange(rows)[:, None] - begun, 0) * rng.choice([-1.0, 1.0], m)


def _turned(world: Session, rows: int, rng: np.random.Generator) -> Array:
    """(R, m) the block turns in its mounting at one row."""
    row, turn, pose = int(rng.integers(SAFE, rows - SAFE)), rng.standard_normal(3), believed(world)
    turned = replace(pose, turn=1e-6 * turn * (np.arange(rows)[:, None] >= row))
    moved = [x - y for x, y in zip(reference_vectors(world, turned), reference_vectors(world, pose), strict=True)]
    n = np.where(world.unit.gyro[:, None], moved[1][:, None, :], moved[0][:, None, :])
    return np.asarray(np.einsum("rmk,mk->rm", n, world.unit.axis))


WALKS, RAMPS, TURNED = "walks", "ramps", "turned"
OTHERS: dict[str, Callable[[Session, int, np.random.Generator], Array]] = {
    WALKS: _walks,
    RAMPS: _ramps,
    TURNED: _turned,
}
"""A block that turns is seen on a stand only: in orientations nothing is known of how it was held."""


def session_of(block: Block, rng: np.random.Generator) -> Session:
    unit = draw_unit(Arrangement(block.accelerometers, block.gyros), rng)
    site = draw_site(rng)
    wanted = Wanted(int(rng.integers(10, 17)), (False, True), rng.random() < 0.7, False, "wander", True, True)
    drawn = draw_noise(unit, None, rng)
    whole = np.hypot(drawn.reading, drawn.repeatability)
    noise = replace(drawn, stated=True) if block.stand else Noise(whole, np.zeros(unit.size))
    return Session(unit, draw_schedule(wanted, rng), site, draw_stand(site, rng), draw_mounting(rng), noise)


def directions(rng: np.random.Generator) -> Array:
    up = rng.standard_normal((ORIENTATIONS, 3))
    return np.asarray(up / np.linalg.norm(up, axis=1, keepdims=True))


def strength_left(block: Block, world: Session, up: Array, sensor: int, steps: Array) -> Array:
    """(S,) standard errors of steps (R, S) of one unit, m/s² or rad/s, beside what the calibration absorbs."""
    columns = np.zeros((steps.shape[0], world.unit.size, steps.shape[1]))
    columns[:, sensor] = steps
    return _left(block, world, up, columns)


def _left(block: Block, world: Session, up: Array, columns: Array) -> Array:
    """(S,) standard errors of what is added (R, m, S) to the input, beside what the calibration absorbs."""
    S = columns.shape[2]
    if block.stand:
        columns = columns * world.unit.scale[:, None]
        return np.asarray(np.linalg.norm(Lens(world).left(columns.reshape(-1, S)), axis=0))
    absorbed = orthonormal(_absorbed(world, up))
    white = (columns / world.noise.reading[:, None]).reshape(-1, S)
    return np.asarray(np.linalg.norm(white - absorbed @ (absorbed.T @ white), axis=0))


def _strength_alone(world: Session, sensor: int, steps: Array) -> Array:
    """(S,) strength of steps with nothing absorbed but a constant."""
    share = steps.mean(axis=0)
    error = np.hypot(world.noise.reading, world.noise.repeatability)[sensor]
    return np.asarray(np.sqrt(np.maximum(len(steps) * share * (1 - share), 1e-9)) / error)


def _absorbed(world: Session, up: Array) -> Array:
    """(R·m, 5m + 2R) columns absorbed by the parameters and by each row's own direction, standard errors."""
    unit, g = world.unit, gravity(world.site)
    a = g * up @ unit.axis.T
    R, m = a.shape
    sides = np.array([across(e) for e in unit.axis])
    own = [a, 1 + 0 * a, a**2, g * up @ sides[:, 0].T, g * up @ sides[:, 1].T]
    columns = np.zeros((R, m, 5 * m + 2 * R))
    for i in range(m):
        columns[:, i, 5 * i : 5 * i + 5] = np.stack([c[:, i] for c in own], axis=-1)
    for j, n in enumerate(up):
        columns[j, :, 5 * m + 2 * j : 5 * m + 2 * j + 2] = g * unit.axis @ np.stack(across(n), axis=1)
    return (columns / world.noise.reading[:, None]).reshape(R * m, -1)


def steps_file(block: Block, world: Session, up: Array, added: Array, rng: np.random.Generator) -> dict[str, Any]:
    if block.stand:
        readings, _ = measure(world, (), rng)
        return session_file(world, readings + world.unit.scale * added)
    unit, g = world.unit, gravity(world.site)
    a = g * up @ unit.axis.T
    error = world.noise.reading
    u = unit.scale * (a + unit.bias + unit.quadratic * a**2 + added + error * rng.standard_normal(a.shape))
    table: dict[str, Any] = {name: u[:, i].tolist() for i, name in enumerate(unit.names)}
    table |= {f"{name}_se": [float(unit.scale[i] * error[i])] * len(up) for i, name in enumerate(unit.names)}
    document = session_file(world, np.zeros((world.schedule.rows, unit.size)))
    document |= {"programme": "arbitrary-orientations", "table": table, "site": {"gravity_m_s2": g}}
    return {key: value for key, value in document.items() if key not in ("stand", "mounting")}
