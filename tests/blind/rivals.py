"""Every explanation that the catalogue offers for a session, as columns of readings, shapes over grids."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from tests.blind.catalogue import CATALOGUE, DISCRETE, HISTORY, SENSOR
from tests.blind.effects_sensor import INPUT, clipped
from tests.blind.physics import mean_readings, reference_vectors
from tests.blind.pose import believed
from tests.blind.world import Array, Effect, Session

CLIPS = 40
TIME_CONSTANTS = np.geomspace(0.03, 1.5, 9)


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation. Columns (G, R·m, p): G shapes of p free amplitudes, or of a fixed size."""

    cause: str
    sensors: tuple[int, ...]
    columns: Array
    fixed: bool = False

    @property
    def name(self) -> tuple[str, tuple[int, ...]]:
        """Cause and sensors."""
        return self.cause, self.sensors


def available(session: Session, cause: str) -> bool:
    """Whether the file holds what the cause needs."""
    schedule, unit = session.schedule, session.unit
    has = {
        "time": schedule.timed,
        "temperature": schedule.thermometer,
        "both runs": schedule.both_runs,
        "stated noise": session.noise.stated,
        "accelerometers": not unit.gyro.all(),
        "gyros": bool(unit.gyro.any()),
        "vibration": schedule.vibration is not None,
        "history": True,
    }
    return all(has[need] for need in CATALOGUE[cause].needs)


def candidates(session: Session, between: bool) -> Iterator[Candidate]:
    """All explanations; those that need other sessions only when ``between``."""
    for cause, hidden in CATALOGUE.items():
        if not available(session, cause) or (hidden.scope == HISTORY and not between):
            continue
        if hidden.scope == SENSOR:
            yield from _of_each_sensor(session, cause)
        elif cause == "positions-swapped":
            yield from _swaps(session)
        elif cause in DISCRETE:
            yield from _records(session, cause)
        elif cause in ("sensor-drift", "g-sensitivity"):
            for i in _sensors_of(session, cause):
                yield Candidate(cause, (i,), _numerical(session, cause, (i,))[None])
        else:
            yield Candidate(cause, (), _numerical(session, cause, ())[None])
            if cause == "latitude-entry" and session.unit.gyro.all():
                yield Candidate("alpha-entry", (), _numerical(session, cause, ())[None])  # the head's angle to the pole


def _sensors_of(session: Session, cause: str) -> list[int]:
    only_gyros = cause == "g-sensitivity"
    return [i for i in range(session.unit.size) if session.unit.gyro[i] or not only_gyros]


def _numerical(session: Session, cause: str, sensors: tuple[int, ...]) -> Array:
    """(R·m, p) central differences of the physics by the amplitudes."""
    size = CATALOGUE[cause].size
    columns = []
    for k in range(size):
        up, down = (
            mean_readings(session, [Effect(cause, tuple(s * step_of(session, cause, k) * np.eye(size)[k]), sensors)])
            for s in (1, -1)
        )
        columns.append((up - down).ravel())
    return np.stack(columns, axis=1)


def step_of(session: Session, cause: str, element: int) -> float:
    """A small amplitude."""
    if cause == "stand-drift":
        return 1e-5 / float(np.ptp(session.schedule.time))
    if cause == "sensor-drift" and element == 1:
        return 1e-5 if not session.unit.gyro.any() else 1e-9
    return 1e-15 if cause == "g-sensitivity" else 1e-5


def shapes(session: Session, cause: str) -> list[tuple[float, ...]]:
    """The grid of what is not an amplitude."""
    R = session.schedule.rows
    if cause == "bias-jump":
        return [(float(j),) for j in range(1, R)]
    if cause == "reading-outlier":
        return [(float(j),) for j in range(R)]
    if cause in ("warm-up", "thermal-lag"):
        return [(float(tau),) for tau in TIME_CONSTANTS * session.schedule.time[-1]]
    return [()]


def _of_each_sensor(session: Session, cause: str) -> Iterator[Candidate]:
    if cause == "excess-noise":
        return
    force, rate = reference_vectors(session, believed(session))
    R, m, is_gyro = session.schedule.rows, session.unit.size, session.unit.gyro
    for i in range(m):
        if cause == "vibration-rectification" and is_gyro[i]:
            continue
        if cause == "saturation":
            yield Candidate(cause, (i,), _clips(session, i), fixed=True)
            continue
        n = rate if session.unit.gyro[i] else force
        a = n @ session.unit.axis[i]
        size = CATALOGUE[cause].size
        grid = shapes(session, cause)
        columns = np.zeros((len(grid), R, m, size))
        for g, shape in enumerate(grid):
            for k in range(size):
                effect = Effect(cause, tuple(np.eye(size)[k]), (i,), shape)
                columns[g, :, i, k] = session.unit.scale[i] * INPUT[cause](session, effect, n, a, force)
        yield Candidate(cause, (i,), columns.reshape(len(grid), R * m, size))


def _clips(session: Session, i: int) -> Array:
    """(G, R·m, 1) parts cut off by limits from just below the extreme to further down, at either side and at both."""
    clean = mean_readings(session)
    grid = []
    for side in (1.0, -1.0, 0.0):
        u = np.abs(clean[:, i]) if side == 0 else side * clean[:, i]
        if u.max() <= 0:
            continue
        for depth in np.geomspace(1e-7, 0.2, CLIPS):
            effect = Effect("saturation", (u.max() * (1 - depth),), (i,), (side,))
            grid.append((clipped(clean, [effect]) - clean).reshape(-1, 1))
    return np.array(grid)


def _swaps(session: Session) -> Iterator[Candidate]:
    clean = mean_readings(session)
    pairs = np.array(list(combinations(range(len(clean)), 2)))
    columns = np.zeros((len(pairs), *clean.shape))
    one, other = pairs.T
    every = np.arange(len(pairs))
    columns[every, one] = clean[other] - clean[one]
    columns[every, other] = clean[one] - clean[other]
    yield Candidate("positions-swapped", (), columns.reshape(len(pairs), -1, 1), fixed=True)


def _records(session: Session, cause: str) -> Iterator[Candidate]:
    clean = mean_readings(session)
    m = session.unit.size
    sets: list[tuple[int, ...]] = [()]
    if cause == "sign-reversed":
        sets = [(i,) for i in range(m)]
    elif cause == "channels-swapped":
        kind = session.unit.gyro
        sets = [(i, k) for i, k in combinations(range(m), 2) if kind[i] == kind[k]]
    for sensors in sets:
        column = mean_readings(session, [Effect(cause, (), sensors)]) - clean
        yield Candidate(cause, sensors, column.reshape(1, -1, 1), fixed=True)
