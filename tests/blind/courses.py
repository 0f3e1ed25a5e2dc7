"""One course that several sensors of a block follow, each by a size of its own; and courses that each has to itself."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.blind.steps import ORIENTATIONS, Block, directions, session_of, steps_file, strength_left
from tests.blind.world import Array, Session

BLOCKS = (
    Block("stand, 6 accelerometers", accelerometers=6),
    Block("stand, 6 gyros", gyros=6),
    Block("orientations, 12 accelerometers", accelerometers=12, stand=False),
    Block("orientations, 24 accelerometers", accelerometers=24, stand=False),
)
SPREAD = 0.6
"""Standard deviation of the ln of the sizes: a sensor in six shows less than half of the usual, one in six almost twice
as much.
"""
SHOWN = 0.4
"""Share of a step that the calibration must leave: one between the runs of a stand is taken for a turn of the axes."""
SAFE = 4
"""Rows before and after a step at least."""


@dataclass(frozen=True, eq=False)
class Driven:
    """A session file and what is true of it."""

    session: dict[str, Any]
    sensors: tuple[str, ...]
    """Names of the sensors that follow."""
    strength: tuple[float, ...]
    """Strength in every one of them, standard errors."""
    size: tuple[float, ...]
    """Size in every one of them, m/s² or rad/s per unit of the course."""
    shape: float
    """Time constant, s, or the first row after a step, counted from 1; 0 where the course has neither."""


def settling(time: Array, rng: np.random.Generator) -> tuple[Array, float]:
    """(R,) exp(−t/τ), τ between an eighth and a half of the session."""
    tau = float(np.ptp(time) * np.exp(rng.uniform(np.log(0.12), np.log(0.5))))
    return np.exp(-time / tau), tau


def stepping(time: Array, rng: np.random.Generator) -> tuple[Array, float]:
    """(R,) one from some row on."""
    row = int(rng.integers(SAFE, len(time) - SAFE))
    return 1.0 * (np.arange(len(time)) >= row), row + 1.0


def drifting(time: Array, rng: np.random.Generator) -> tuple[Array, float]:
    """(R,) time, the whole session being one."""
    return time / np.ptp(time), 0.0


def roaming(time: Array, rng: np.random.Generator) -> tuple[Array, float]:
    """(R,) the temperature of a room that nobody recorded: heating and sun, waves of half a session to two."""
    turns = 2 * np.pi * time[:, None] / (np.ptp(time) * rng.uniform(0.5, 2.0, 3)) + rng.uniform(0, 2 * np.pi, 3)
    return np.sin(turns) @ rng.uniform(0.4, 1.0, 3), 0.0


COURSES: dict[str, Callable[[Array, np.random.Generator], tuple[Array, float]]] = {
    "exponential": settling,
    "step": stepping,
    "ramp": drifting,
    "room": roaming,
}


def draw_course(
    block: Block, course: str, count: int, together: float, rng: np.random.Generator, *, even: bool = False
) -> Driven:
    """A session in which so many sensors follow one course, all ``together`` of so many standard errors; ``even``: each
    of as many.
    """
    world, up, time = _world(block, rng)
    m = world.unit.size
    shape, value = COURSES[course](time, rng)
    sensors = np.sort(rng.choice(m, count, replace=False))
    if course == "step" and _share_left(block, world, up, sensors, shape) < SHOWN:
        return draw_course(block, course, count, together, rng, even=even)
    each = np.ones(count) if even else np.exp(SPREAD * rng.standard_normal(count))
    strengths = together * each / np.linalg.norm(each)
    seen = np.array([float(strength_left(block, world, up, int(i), shape[:, None])[0]) for i in sensors])
    size = rng.choice([-1.0, 1.0], count) * strengths / seen
    added = np.zeros((len(time), m))
    added[:, sensors] = shape[:, None] * size
    names = tuple(world.unit.names[i] for i in sensors)
    document = _document(block, world, up, time, added, rng)
    return Driven(document, names, tuple(strengths.tolist()), tuple(size.tolist()), value)


def draw_apart(block: Block, course: str, count: int, each: float, rng: np.random.Generator) -> Driven:
    """A session in which so many sensors follow courses of their own, ``each`` of so many standard errors."""
    world, up, time = _world(block, rng)
    m = world.unit.size
    sensors = np.sort(rng.choice(m, count, replace=False))
    added, size = np.zeros((len(time), m)), []
    for i in sensors:
        shape, _ = COURSES[course](time, rng)
        size.append(rng.choice([-1.0, 1.0]) * each / float(strength_left(block, world, up, int(i), shape[:, None])[0]))
        added[:, i] = size[-1] * shape
    names = tuple(world.unit.names[i] for i in sensors)
    return Driven(_document(block, world, up, time, added, rng), names, (each,) * count, tuple(map(float, size)), 0.0)


def draw_departing(block: Block, count: int, each: float, rng: np.random.Generator, *, second: bool) -> Driven:
    """All sensors settle, about ``each`` by so many standard errors; ``count`` of them with a time constant of their
    own, or, ``second``, with a quicker course of their own beside the one that all follow. Its sensors are those."""
    world, up, time = _world(block, rng)
    m, tau = world.unit.size, float(np.ptp(time) * np.exp(rng.uniform(np.log(0.3), np.log(1.7))))
    departing = np.sort(rng.choice(m, count, replace=False))
    added, strengths, sizes = np.zeros((len(time), m)), [], []

    def put(sensor: int, constant: float, strength: float) -> float:
        shape = np.exp(-time / constant)
        seen = float(strength_left(block, world, up, sensor, shape[:, None])[0])
        size = float(rng.choice([-1.0, 1.0]) * strength / seen)
        added[:, sensor] += size * shape
        return size

    for i in range(m):
        departs = i in departing
        factor = float(np.exp(rng.choice([-1, 1]) * rng.uniform(np.log(1.5), np.log(4.0)))) if departs else 1.0
        strength = float(each * np.exp(SPREAD * rng.standard_normal()))
        size = put(i, tau if second else tau * factor, strength)
        if departs:
            strengths.append(strength)
            sizes.append(size)
        if departs and second:
            own = strength * rng.uniform(0.25, 0.6)
            put(i, 0.25 * tau, own)
    names = tuple(world.unit.names[i] for i in departing)
    document = _document(block, world, up, time, added, rng)
    return Driven(document, names, tuple(strengths), tuple(sizes), tau)


def draw_settling_at(block: Block, shares: Array, each: float, rng: np.random.Generator) -> Driven:
    """Sensors that settle with time constants of so many ``shares`` (k,) of the session, one apiece."""
    world, up, time = _world(block, rng)
    m = world.unit.size
    sensors = np.sort(rng.choice(m, len(shares), replace=False))
    added = np.zeros((len(time), m))
    for i, share in zip(sensors, shares, strict=True):
        shape = np.exp(-time / (share * np.ptp(time)))
        seen = float(strength_left(block, world, up, int(i), shape[:, None])[0])
        added[:, i] = rng.choice([-1.0, 1.0]) * each / seen * shape
    names = tuple(world.unit.names[i] for i in sensors)
    return Driven(_document(block, world, up, time, added, rng), names, (each,) * len(shares), (), 0.0)


SOUND, COLD, BOTH, CHANGED = "sound", "cold start", "cold start, one sensor changed for good", "two to four changed"
WARM = 6.0
"""Time constants that a session begins after switching on at least, if it is no cold start: 0.2 % are left."""
CHANGE = 15.0
"""Standard errors of a mean by which a zero changes for good; twice as many of what it settles to beside a course."""


@dataclass(frozen=True, eq=False)
class Life:
    """Session files of one unit, oldest first, and what is true of the last."""

    sessions: tuple[dict[str, Any], ...]
    tau: float
    """s, of a cold start; 0 where it is none."""
    changed: tuple[str, ...]
    """Sensors whose zeros have changed for good."""


def draw_life(block: Block, kind: str, each: float, rng: np.random.Generator, *, earlier: int = 3) -> Life:
    """``earlier`` sessions of a warm unit, one a month, then one that is sound, one with a ``COLD`` start that moves
    every sensor, each by about ``each`` standard errors, or one in which sensors have changed for good.
    """
    world, up, time = _world(block, rng)
    m, tau = world.unit.size, float(np.ptp(time) * rng.uniform(0.3, 0.8))
    shape, error = np.exp(-time / tau), np.hypot(world.noise.reading, world.noise.repeatability) / np.sqrt(len(time))
    seen = np.array([float(strength_left(block, world, up, i, shape[:, None])[0]) for i in range(m)])
    size = rng.choice([-1.0, 1.0], m) * each * np.exp(SPREAD * rng.standard_normal(m)) / seen
    count = {BOTH: 1, CHANGED: int(rng.integers(2, 5))}.get(kind, 0)
    moved, change = np.sort(rng.choice(m, count, replace=False)), np.zeros(m)
    alike = float(np.mean(shape) ** 2 / np.mean(shape**2)) if kind == BOTH else 0.0
    known = error[moved] / np.sqrt(1 - alike)
    change[moved] = rng.choice([-1.0, 1.0], count) * CHANGE * known * (2.0 if kind == BOTH else 1.0)
    cold, sessions = kind in (COLD, BOTH), list[dict[str, Any]]()
    for month in range(1, earlier + 2):
        last = month > earlier
        since = tau * (rng.uniform(0.02, 0.2) if last and cold else rng.uniform(WARM, 2 * WARM))
        added = np.exp(-since / tau) * shape[:, None] * size + change * last
        dated = replace(world, started_at=f"2026-{month:02d}-01T09:00:00Z")
        document = _document(block, dated, directions(rng), time, added, rng)
        sessions.append(document | {"time_since_power_on_s": round(since, 1)})
    return Life(tuple(sessions), tau if cold else 0.0, tuple(world.unit.names[i] for i in moved))


def _share_left(block: Block, world: Session, up: Array, sensors: Array, shape: Array) -> float:
    """Least share, over some sensors, of a step (R,) that the calibration leaves."""
    error = np.hypot(world.noise.reading, world.noise.repeatability)
    alone = np.linalg.norm(shape - shape.mean()) / error
    return min(float(strength_left(block, world, up, int(i), shape[:, None])[0] / alone[i]) for i in sensors)


def _world(block: Block, rng: np.random.Generator) -> tuple[Session, Array, Array]:
    """The session, directions of up in orientations, and (R,) time, s, from 0."""
    world, up = session_of(block, rng), directions(rng)
    world = replace(world, schedule=replace(world.schedule, thermometer=False))
    if block.stand:
        return world, up, world.schedule.time - world.schedule.time[0]
    return world, up, np.round(np.cumsum(rng.uniform(60, 120, ORIENTATIONS)), 1)


def _document(
    block: Block, world: Session, up: Array, time: Array, added: Array, rng: np.random.Generator
) -> dict[str, Any]:
    document = steps_file(block, world, up, added, rng)
    document["table"] |= {"time_s": time.tolist()}
    return document
