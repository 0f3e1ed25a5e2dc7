"""A log in parts → its averaged positions."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.errors import Problem, ScheduleError
from estimator.long_logs.tally import RowTally, check_alike
from estimator.message import say
from estimator.reading.problems import Problems
from estimator.reading.schedule import check_schedule
from estimator.rest_noise import block_count
from estimator.screening.gaps import filled, moments, smallest_steps
from estimator.session import Array, CalibrationSession
from estimator.static import (
    FEWEST,
    THRESHOLDS,
    Intervals,
    Quietness,
    TiltResponse,
    block_length,
    enough,
    no_rests_message,
    quietness_of,
    require_still,
    still,
    trimmed,
    watched_for_rest,
)

MOST_RESTS = 4_000
"""Positions of a log: forty times those of a long session, and some ten megabytes of sums."""


@dataclass(frozen=True, eq=False)
class LongLog:
    """A raw log of any length."""

    parts: Callable[[], Iterator[CalibrationSession]]
    """All its rows, in order, some at a time, each part as a session; anew at every call."""
    labels: Callable[[], Iterator[Array]] | None
    """Yields the (r, k) labels of the rows of each part: position, or the settings of a stand; None where rows have no
    labels.
    """


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
    """The fault of labels that change all the time, as a message."""
    return say(
        "changes {count} times or more; a log of {most_rests} positions can be averaged, so split it",
        count=count,
        most_rests=MOST_RESTS,
    )


def too_many_rests(count: int) -> str:
    """The fault of a log that stands still too often, as a message."""
    return say(
        "the block is still {count} times; a log of {most_rests} positions can be averaged, so split it",
        count=count,
        most_rests=MOST_RESTS,
    )


Mask = NDArray[np.bool_]


def average_long(
    log: LongLog, residual: Callable[[CalibrationSession], float], tilts: TiltResponse | None = None
) -> CalibrationSession:
    """The averaged session of a raw log in parts: what `estimator.static.average` makes of it in one piece.

    Raises
    ------
    FormatError
        A part cannot be used.
    ScheduleError
        The log holds no position, too many, or too few that stand still.
    """
    tally = _labelled(log) if log.labels is not None else _chosen(log, residual)
    kept = kept_of(tally)
    session = (tally if kept.all() else tally.at(kept)).session(tilts)
    problems = Problems(None)
    kinds = {sensor.kind for sensor in session.sensors}
    check_schedule(session.programme, session, kinds, raw=True, problems=problems)
    problems.raise_if_any()
    return session


def kept_of(tally: RowTally) -> Mask:
    """(n,) the rests of which every channel holds readings; ScheduleError where there is none."""
    sensors = tally.head.sensors
    kept = enough(tally.rests, tally.known[:, : len(sensors)], sensors)
    return np.isin(tally.rests.start, kept.start)


def _labelled(log: LongLog) -> RowTally:
    head = next(log.parts())
    rests = labelled_rests(log, positions=head.position is not None)
    (tally,) = _tallied(log, [rests])
    (moves,) = _moving(log, [tally])
    require_still(rests, moves)
    return tally


def _rows(log: LongLog) -> Iterator[tuple[int, CalibrationSession]]:
    """Every part with its first row; FormatError where they do not follow one another."""
    at, head = 0, None
    for part in log.parts():
        head = head or part
        check_alike(head, part, at)
        yield at, part
        at += len(part.readings)


def _tallied(log: LongLog, choices: Sequence[Intervals]) -> list[RowTally]:
    """The sums over several choices of rests, in one pass."""
    head = next(log.parts())
    tallies = [RowTally(head, rests) for rests in choices]
    for at, part in _rows(log):
        for tally in tallies:
            tally.add(part, at)
    return tallies


def _moving(log: LongLog, tallies: Sequence[RowTally]) -> list[Mask]:
    """(n,) bool for every choice: rests in which the block moves. Makes another pass, only where one may."""
    moves = [np.zeros(len(tally.rests), dtype=bool) for tally in tallies]
    doubtful = [k for k, tally in enumerate(tallies) if tally.may_move()]
    if doubtful:
        for k, jitter in zip(doubtful, _jitters(log, [tallies[k].rests for k in doubtful]), strict=True):
            moves[k] = tallies[k].moving(jitter)
    return moves


def _jitters(log: LongLog, choices: Sequence[Intervals]) -> list[Array]:
    """(n, m) sums of the squared changes from every sample of a rest to the next, reading units squared."""
    m = len(next(log.parts()).sensors)
    sums = [np.zeros((len(rests), m)) for rests in choices]
    before = np.empty((0, m))
    for at, part in _rows(log):
        readings = filled(np.concatenate([before, part.readings]))
        squares, begin = np.diff(readings, axis=0) ** 2, at - len(before)
        for total, rests in zip(sums, choices, strict=True):
            low, high = np.searchsorted(rests.stop, begin, "right"), np.searchsorted(rests.start, begin + len(squares))
            for i in range(int(low), int(high)):
                total[i] += squares[max(rests.start[i] - begin, 0) : max(rests.stop[i] - begin, 0)].sum(axis=0)
        before = readings[-1:]
    return sums


def _chosen(log: LongLog, residual: Callable[[CalibrationSession], float]) -> RowTally:
    """Sums over the rests under the threshold that calibrates best, as `estimator.static.best`."""
    seen = _quietness(log)
    choices = [still(seen.quiet, threshold, seen.rate) for threshold in THRESHOLDS]
    tried: dict[tuple[int, ...], tuple[float, RowTally]] = {}
    for tally in _calm(log, choices):
        key = (*tally.rests.start.tolist(), *tally.rests.stop.tolist())
        if key not in tried:
            tried[key] = (residual(tally.session()), tally)
    if not tried:
        count = sorted(map(len, choices))[len(choices) // 2]
        fault = no_rests_message(seen.samples) if count <= MOST_RESTS else too_many_rests(count)
        raise ScheduleError([Problem("table", fault)])
    return min(tried.values(), key=lambda pair: pair[0])[1]


def _calm(log: LongLog, choices: Sequence[Intervals]) -> list[RowTally]:
    """The sums over the rests of every choice in which the block does not move, where they are enough."""
    usable = [rests for rests in choices if FEWEST <= len(rests) <= MOST_RESTS]
    tallies = _tallied(log, usable) if usable else []
    calm: list[RowTally | Intervals] = []
    for tally, moves in zip(tallies, _moving(log, tallies), strict=True):
        rests = tally.rests.at(~moves)
        if len(rests) >= FEWEST:
            calm.append(tally.at(~moves) if (block_count(rests.samples) or 1) == tally.blocks else rests)
    again = iter(_tallied(log, [rests for rests in calm if isinstance(rests, Intervals)]))
    return [next(again) if isinstance(rests, Intervals) else rests for rests in calm]


@dataclass(frozen=True, eq=False)
class _SeenRows:
    """Facts about a log that are needed before its rests are looked for."""

    quiet: Quietness
    rate: float
    """Hz."""
    samples: int


def _quietness(log: LongLog) -> _SeenRows:
    head = next(log.parts())
    assert head.sample_rate is not None
    block, watched = block_length(head.sample_rate), watched_for_rest(head)
    means, withins, steps = [], [], np.full(np.count_nonzero(watched), np.inf)
    remainder, before, samples = np.empty((0, np.count_nonzero(watched))), None, 0
    for at, part in _rows(log):
        readings = part.readings[:, watched]
        new = filled(readings if before is None else np.concatenate([before, readings]))
        steps = np.minimum(steps, smallest_steps(new))
        readings = np.concatenate([remainder, readings])
        mean, within = moments(readings, block)
        means.append(mean)
        withins.append(within)
        remainder, before, samples = readings[len(mean) * block :], new[-1:], at + len(part.readings)
    quiet = quietness_of(block, np.concatenate(means), np.concatenate(withins), steps)
    return _SeenRows(quiet, head.sample_rate, samples)
