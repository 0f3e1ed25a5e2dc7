"""Sessions of one block on one stand, small and quick, with a hidden effect where it is wanted."""

from dataclasses import replace
from functools import cache

import numpy as np

from estimator import CalibrationSession, read_session
from tests.blind.draw import draw_earlier, draw_session
from tests.blind.physics import measure
from tests.blind.world import Effect, Session
from tests.blind.write import session_file

NEEDS = frozenset({"time", "temperature", "both runs", "stated noise", "accelerometers"})


@cache
def world(seed: int = 1) -> Session:
    """Six accelerometers, both runs, everything stated."""
    rng = np.random.default_rng(seed)
    while True:
        session = draw_session(rng, NEEDS, 12)
        if session.unit.size == 6 and not session.unit.gyro.any():
            return session


def worlds(count: int, seed: int = 1) -> list[Session]:
    """Sessions of one unit on one stand, of different schedules, a month apart."""
    rng, first = np.random.default_rng([seed, 1]), world(seed)
    dates = [f"{2020 + k // 12}-{k % 12 + 1:02d}-01T00:00:00Z" for k in range(count)]
    return [replace(draw_earlier(first, rng, 12), stand=first.stand, started_at=date) for date in dates]


def measured(session: Session, effects: list[Effect], seed: int) -> CalibrationSession:
    """The session as a file would give it."""
    return read_session(session_file(session, measure(session, effects, np.random.default_rng(seed))[0]))
