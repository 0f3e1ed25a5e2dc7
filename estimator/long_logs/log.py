"""A log that comes in parts, and where its labels change."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from estimator.errors import Problem, ScheduleError
from estimator.session import Array, CalibrationSession
from estimator.static import Intervals, trimmed

MOST_RESTS = 4_000
"""Positions of a log: forty times those of a long session, and some ten megabytes of sums."""


@dataclass(frozen=True, eq=False)
class LongLog:
    """A raw log of any length."""

    parts: Callable[[], Iterator[CalibrationSession]]
    """All its rows, in order, some at a time, each part as a session; anew at every call."""
    labels: Callable[[], Iterator[Array]] | None
    """(r, k) what labels the rows of each part: position, or the settings of a stand; None where nothing does."""


def labelled_rests(log: LongLog, *, positions: bool) -> Intervals:
    """Stretches of one label, trimmed; ``positions``: only labels ≥ 0 name one. ScheduleError where none does."""
    assert log.labels is not None
    starts, values, at, last = [np.zeros(0, np.intp)], [], 0, None
    count = 0
    for part in log.labels():
        before = part[:1] + 1 if last is None else last
        change = np.flatnonzero((np.diff(np.concatenate([before, part]), axis=0) != 0).any(axis=1))
        starts.append(at + change)
        values.append(part[change, 0])
        at, last, count = at + len(part), part[-1:], count + len(change)
        if count > 2 * MOST_RESTS + 1:
            raise ScheduleError([Problem("position", too_many(count))])
    start = np.concatenate(starts)
    stop = np.append(start[1:], at)
    named = np.concatenate(values) >= 0 if positions else np.ones(len(start), dtype=bool)
    if np.count_nonzero(named) > MOST_RESTS:
        raise ScheduleError([Problem("position", too_many(int(np.count_nonzero(named))))])
    return trimmed(start[named], stop[named])


def too_many(count: int) -> str:
    """What is wrong with labels that change all the time."""
    return f"changes {count} times or more; a log of {MOST_RESTS} positions can be averaged, so split it"
