"""Raw log → averaged positions: where the block stood still, the means there, and how good they are.

Positions come from the log's own labels, from a stand's settings, or are found: windows of about a second whose
variance, in units of each channel's noise floor, stays below a threshold. The threshold is not set by hand: each of a
grid is tried, and the one whose positions calibrate with the least residual per degree of freedom is kept (Tedaldi,
Pretto and Menegatti, ICRA 2014, choose it the same way).

The standard error of a mean allows for noise that hangs together: it is taken from the spectrum that all positions
show, and not from the scatter of samples (`estimator.rest_noise`). Where the calibration says how the readings respond
to a tilt of the block, a slow tilt within a rest is no sensor's own error (`estimator.rest_tilt`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.errors import Problem, ScheduleError, problem_at
from estimator.message import joined, say
from estimator.rest_noise import Indices, waves
from estimator.rest_tilt import MeanErrors, errors_of_means
from estimator.screening.gaps import ends, filled, moments, noise_floor, smallest_steps, without_stray
from estimator.session import ACCELEROMETER, Array, CalibrationSession, RawRests, Sensor

WINDOW = 1.0
"""s over which the variance is taken: long beside the samples, short beside a rest of some seconds."""

BLOCKS = 4
"""Blocks a window: the resolution of the ends of an interval, and what is trimmed from each."""

SHORTEST = 1.0
"""s of standing still, after trimming, that make a position: as long as the window."""

THRESHOLDS = (1.5, 2.0, 3.0, 4.5, 7.0, 10.0, 15.0, 25.0, 40.0, 70.0)
"""Variances, in noise floors averaged over the channels, below which a window may count as still. Steps of about a
half, from just above the scatter of a variance of some hundred samples to where slow turns pass."""

FEWEST = 4
"""Positions below which a threshold is not considered: a sphere needs four points."""

TRIM = 0.05
"""Part cut off each end of a labelled position: people label a little early and late."""

SAME_TIME = 1e-3
"""Relative difference of count time and sample interval up to which counts follow one another without a gap."""

MOTION = 0.02
"""g; change of a reading from quarter to quarter of a stretch from which the block moves: a turn of a degree, which no
table that rests makes and no warm-up imitates."""

PIECES = 4
"""Quarters in which a stretch is looked at for a slow turn: they show one that comes back to where it began."""

KEPT = 0.1
"""Part of a rest's samples that every channel must keep: a logger polls hardly ten times faster than its sensor."""

DISTINCT = 30.0
"""Standard errors of a quarter's mean by the noise from sample to sample, which that change must exceed as well: far
more than white noise gives, because slow noise is not counted in them."""


@dataclass(frozen=True, eq=False)
class Intervals:
    """Stretches of a log in which the block stood still, in order, not touching."""

    start: Indices
    """(n,) first sample."""
    stop: Indices
    """(n,) one past the last sample."""

    def __len__(self) -> int:
        return len(self.start)

    @property
    def samples(self) -> Indices:
        """(n,) number of samples."""
        return self.stop - self.start

    def at(self, chosen: NDArray[np.bool_]) -> "Intervals":
        """The stretches that are ``chosen`` (n,)."""
        return Intervals(self.start[chosen], self.stop[chosen])

    def sums(self, values: Array) -> Array:
        """(n, ...) sums of values (R, m), or of any shape (R, ...) and unit, over each interval; NaN left out."""
        if (none := np.isnan(values)).any():
            values = np.where(none, 0.0, values)
        edges = np.stack([self.start, self.stop], axis=1).ravel()
        padded = np.concatenate([values, np.zeros_like(values[:1])])
        return np.asarray(np.add.reduceat(padded, edges, axis=0)[::2])

    def means(self, values: Array) -> Array:
        """(n, ...) means of values (R, m), or of any shape (R, ...) and unit, over each interval."""
        sums, known = self.sums(values), np.isfinite(values)
        if not known.all():
            with np.errstate(invalid="ignore"):
                return np.asarray(sums / self.sums(known.astype(float)))
        return sums / self.samples.reshape(-1, *[1] * (sums.ndim - 1))


TiltResponse = Callable[[CalibrationSession], Array | None]
"""Function of an averaged session: (n, m, 2) change of every reading, in its unit per rad, with the two tilts of its
row, 0 for gyros; None where a tilt is an error of its row.
"""


def average(
    session: CalibrationSession, residual: Callable[[CalibrationSession], float], tilts: TiltResponse | None = None
) -> CalibrationSession:
    """The averaged session of a raw log: one row a position, with standard errors.

    Parameters
    ----------
    session : a raw log (`is_raw`).
    residual : residual per degree of freedom of an averaged session, by which the threshold is chosen; infinite
        where the positions do not determine the calibration.
    tilts : how the rows respond to a tilt of the block; None: all noise is taken for the sensors' own.

    Raises
    ------
    ScheduleError
        The log holds no position, or too few that stand still.
    """
    if session.position is not None:
        intervals = at_rest(session, labelled(session.position))
    elif session.beta is not None and session.flipped is not None:
        setting = np.column_stack([session.beta, session.flipped])
        changed = np.any(np.diff(setting, axis=0) != 0, axis=1)
        intervals = at_rest(session, labelled(np.concatenate([[0], np.cumsum(changed)])))
    else:
        intervals = best(session, residual)
    intervals = with_readings(session, intervals)
    whole, session = session, without_stray(session, intervals.start, intervals.stop)
    assert whole.sample_rate is not None
    rests = RawRests(whole.readings, whole.time, whole.sample_rate, intervals.start, intervals.stop)
    rows = replace(averaged(session, intervals), rests=rests)
    if session is not whole:
        rows = replace(rows, at_ends=intervals.means(ends(whole.readings)))
    response = None if tilts is None else tilts(rows)
    if response is None:
        return rows
    errors = errors_by_kind(session, intervals, response)
    return replace(rows, standard_errors=errors.alone, tilt_error=errors.tilt)


def with_readings(session: CalibrationSession, intervals: Intervals) -> Intervals:
    """The rests of which every channel holds readings; ScheduleError where none is left."""
    known = np.isfinite(session.readings)
    return intervals if known.all() else enough(intervals, intervals.sums(known.astype(float)), session.sensors)


def enough(intervals: Intervals, known: Array, sensors: tuple[Sensor, ...]) -> Intervals:
    """The stretches with enough samples ``known`` (n, m) of every channel for a mean."""
    least = np.minimum(np.maximum(KEPT * intervals.samples, 2), intervals.samples)
    held = known >= least[:, None]
    if len(held) and not held.all(axis=1).any():
        name = sensors[int(held.sum(axis=0).argmin())].name
        text = "has readings in hardly any rest: nearly all its samples were left out; record it again, or remove it"
        raise ScheduleError([Problem(name, text)])
    return intervals.at(held.all(axis=1))


def labelled(position: NDArray[np.int64]) -> Intervals:
    """Stretches of one label ≥ 0 among labels (R,), trimmed at both ends; ScheduleError where there is none."""
    change = np.flatnonzero(np.diff(position)) + 1
    start = np.concatenate([[0], change])
    stop = np.concatenate([change, [len(position)]])
    named = position[start] >= 0
    return trimmed(start[named], stop[named])


def trimmed(start: Indices, stop: Indices) -> Intervals:
    """Labelled stretches from ``start`` to ``stop`` (n,), cut at both ends; ScheduleError where there is none."""
    if not len(start):
        raise ScheduleError([Problem("position", "no sample belongs to a position; label the still stretches 0, 1, …")])
    trim = (TRIM * (stop - start)).astype(np.intp)
    return Intervals(start + trim, stop - trim)


def at_rest(session: CalibrationSession, intervals: Intervals) -> Intervals:
    """The labelled stretches; ScheduleError where the block moves in most of them."""
    return require_still(intervals, moving(session, intervals))


def require_still(intervals: Intervals, moves: NDArray[np.bool_]) -> Intervals:
    """The labelled stretches; ScheduleError where the block ``moves`` (n,) in most of them."""
    if 2 * np.count_nonzero(moves) <= len(intervals):
        return intervals
    rows = joined(
        ", ",
        (
            say("{first} to {last}", first=a + 1, last=b)
            for a, b in zip(intervals.start[moves][:3], intervals.stop[moves][:3], strict=True)
        ),
    )
    raise ScheduleError(
        [
            problem_at(
                "table",
                "the block moves in {moves} of {intervals} positions (samples {rows}, …): it turns by more than "
                "{motion} rad where it should be at rest; label still samples only, or check sample_rate_hz",
                moves=np.count_nonzero(moves),
                intervals=len(intervals),
                rows=rows,
                motion=f"{MOTION:g}",
            )
        ]
    )


def moving(session: CalibrationSession, intervals: Intervals) -> NDArray[np.bool_]:
    """(n,) whether the block turns in a stretch: an accelerometer drifts by more than `MOTION` g, far beyond its noise.

    A slow turn is as quiet as rest to a short window; over a whole stretch it is not.
    """
    moves = np.zeros(len(intervals), dtype=bool)
    if not long_enough_to_move(intervals):
        return moves
    quarter = intervals.samples // PIECES
    pieces = [Intervals(intervals.start + k * quarter, intervals.start + (k + 1) * quarter) for k in range(PIECES)]
    for i, sensor in enumerate(session.sensors):
        if sensor.kind == ACCELEROMETER:
            values = filled(session.readings[:, i : i + 1])[:, 0]
            drift = np.ptp([piece.means(values) for piece in pieces], axis=0)
            if (drift > far_turn(sensor)).any():
                jitter = intervals.sums(np.diff(values, append=values[-1]) ** 2) / (2 * intervals.samples)
                moves |= turned(sensor, drift, jitter / quarter)
    return moves


def long_enough_to_move(intervals: Intervals) -> bool:
    """Whether the stretches are long enough to look at their quarters."""
    return len(intervals) > 0 and bool(intervals.samples.min() >= 2 * PIECES)


def far_turn(sensor: Sensor) -> float:
    """Change of an accelerometer's reading, reading units, that is taken for a turn where it is distinct."""
    return MOTION * STANDARD_GRAVITY * sensor.nominal_scale


def turned(sensor: Sensor, drift: Array, variance: Array) -> NDArray[np.bool_]:
    """(n,) whether a ``drift`` (n,) over the quarters is a turn, the noise of whose means has a ``variance`` (n,)."""
    return (drift > far_turn(sensor)) & (drift > DISTINCT * np.sqrt(variance))


@dataclass(frozen=True, eq=False)
class Quietness:
    """Variance of each window of a log."""

    block: int
    """Samples a block; windows start at every block and are `BLOCKS` long."""
    ratio: Array
    """(W,) variance in noise floors, averaged over the channels."""


def quietness(readings: Array, rate: float) -> Quietness:
    """Variance of every window of readings (R, m), any unit, sampled at ``rate`` Hz, in noise floors."""
    block = block_length(rate)
    return quietness_of(block, *moments(readings, block), smallest_steps(readings))


def block_length(rate: float) -> int:
    """Samples a block at ``rate`` Hz."""
    return max(round(WINDOW * rate / BLOCKS), 2)


def quietness_of(block: int, mean: Array, within: Array, steps: Array) -> Quietness:
    """Quietness from the `moments` (blocks, m) of blocks of so many samples, and the `smallest_steps` (m,), reading
    units.
    """
    count, m = mean.shape
    if count < BLOCKS:
        return Quietness(block, np.empty(0))
    total, known = np.zeros(count - BLOCKS + 1), np.zeros(count - BLOCKS + 1)
    for i in range(m):
        view = np.lib.stride_tricks.sliding_window_view
        variance = view(within[:, i], BLOCKS).mean(axis=1) + view(mean[:, i], BLOCKS).var(axis=1)
        usable = np.isfinite(variance)
        if usable.any():
            ratio = variance / noise_floor(variance[usable], float(steps[i]))
            total[usable] += ratio[usable]
            known += usable
    return Quietness(block, np.divide(total, known, out=np.full_like(total, np.inf), where=known > 0))


def still(quiet: Quietness, threshold: float, rate: float) -> Intervals:
    """Stretches whose windows stay below the threshold, a block trimmed at both ends.

    A motion raises every window that it touches, `BLOCKS` or more; fewer above the threshold are noise.
    """
    below = np.concatenate([[False], quiet.ratio < threshold, [False]])
    edges = np.flatnonzero(np.diff(below.astype(np.int8)))
    first, end = edges[::2], edges[1::2]
    moved = first[1:] - end[:-1] >= BLOCKS
    first, end = first[np.r_[True, moved][: len(first)]], end[np.r_[moved, True][: len(end)]]
    start = (first + 1) * quiet.block
    stop = (end + BLOCKS - 2) * quiet.block
    enough = stop - start >= SHORTEST * rate
    return Intervals(start[enough], stop[enough])


def best(session: CalibrationSession, residual: Callable[[CalibrationSession], float]) -> Intervals:
    """The rests under the threshold that calibrates best; ScheduleError where none finds enough of them."""
    assert session.sample_rate is not None
    quiet = quietness(session.readings[:, watched_for_rest(session)], session.sample_rate)
    tried: dict[tuple[int, ...], tuple[float, Intervals]] = {}
    for threshold in THRESHOLDS:
        intervals = still(quiet, threshold, session.sample_rate)
        intervals = intervals.at(~moving(session, intervals))
        key = (*intervals.start.tolist(), *intervals.stop.tolist())
        if len(intervals) >= FEWEST and key not in tried:
            kept = with_readings(session, intervals)
            tried[key] = (residual(averaged(without_stray(session, kept.start, kept.stop), kept)), intervals)
    if not tried:
        raise ScheduleError([Problem("table", no_rests_message(len(session.readings)))])
    return min(tried.values(), key=lambda pair: pair[0])[1]


def watched_for_rest(session: CalibrationSession) -> NDArray[np.bool_]:
    """(m,) the channels that tell whether the block stands still: accelerometers, or all where there is none."""
    accelerometers = np.array([s.kind == ACCELEROMETER for s in session.sensors])
    return accelerometers if accelerometers.any() else ~accelerometers


def no_rests_message(samples: int) -> str:
    """The message to a person whose log never stands still."""
    return say(
        "in {samples} samples the block is still for {window} s fewer than {fewest} times; rest longer in each "
        "orientation, check sample_rate_hz, or label the still samples in a position column",
        fewest=FEWEST,
        samples=samples,
        window=f"{WINDOW + SHORTEST:g}",
    )


def averaged(session: CalibrationSession, intervals: Intervals) -> CalibrationSession:
    """One row an interval. What is set rather than read (run, β, directions) is taken from its first sample."""
    assert session.sample_rate is not None
    start = intervals.start
    middle = (intervals.start + intervals.stop - 1) / 2 / session.sample_rate
    return replace(
        session,
        readings=intervals.means(session.readings),
        standard_errors=errors_by_kind(session, intervals).alone,
        at_ends=intervals.means(ends(session.readings)),
        vibration=variances(session, intervals),
        time=middle if session.time is None else intervals.means(session.time),
        temperature=None if session.temperature is None else intervals.means(session.temperature),
        flipped=None if session.flipped is None else session.flipped[start],
        beta=None if session.beta is None else session.beta[start],
        directions=None if session.directions is None else session.directions[start],
        position=None if session.position is None else session.position[start],
        sample_rate=None,
        counts_averaged=intervals.samples.astype(float) if contiguous(session) else None,
    )


def variances(session: CalibrationSession, intervals: Intervals) -> Array:
    """(n, m) variance of the input within every interval, by nominal scales, (m/s²)² or (rad/s)²."""
    inputs = session.readings / [s.nominal_scale for s in session.sensors]
    inputs = inputs - np.nanmean(inputs, axis=0)
    return np.maximum(intervals.means(inputs**2) - intervals.means(inputs) ** 2, 0.0)


def contiguous(session: CalibrationSession) -> bool:
    """Whether the samples are pulse counts, each of which begins where the one before ends."""
    assert session.sample_rate is not None
    return session.count_time is not None and abs(session.count_time * session.sample_rate - 1.0) < SAME_TIME


def mean_errors(readings: Array, intervals: Intervals, response: Array | None = None) -> MeanErrors:
    """Errors of the means of readings (R, m) of sensors of one kind; ``response`` (n, m, 2) as in `TiltResponse`.

    NaN where every interval is a single sample.
    """
    shown = waves(readings, intervals.start, intervals.stop)
    if shown is None:
        return MeanErrors(np.full((len(intervals), readings.shape[1]), np.nan))
    return errors_of_means(shown, response)


def errors_of_kinds(
    session: CalibrationSession, found: Callable[[list[int], Array | None], MeanErrors], response: Array | None
) -> MeanErrors:
    """Errors of the means of all channels: ``found`` works out those of one kind together, given their numbers."""
    kinds = [s.kind for s in session.sensors]
    alike = {kind: [i for i, other in enumerate(kinds) if other == kind] for kind in sorted(set(kinds))}
    parts = [
        found(channels, None if response is None or kind != ACCELEROMETER else response[:, channels])
        for kind, channels in alike.items()
    ]
    errors = np.concatenate([part.alone for part in parts], axis=1)
    tilt = next((part.tilt for part in parts if part.tilt is not None), None)
    return MeanErrors(errors[:, np.argsort([i for channels in alike.values() for i in channels])], tilt)


def errors_by_kind(session: CalibrationSession, intervals: Intervals, response: Array | None = None) -> MeanErrors:
    """`errors_of_kinds` over the intervals, reading units."""
    return errors_of_kinds(
        session, lambda channels, tilts: mean_errors(session.readings[:, channels], intervals, tilts), response
    )
