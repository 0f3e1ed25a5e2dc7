"""Streams of several IMUs, each with its own times → rows that all of them share: means over equal spans of time.

A row is the mean of what came within its span. Where a stream has nothing in it, because the log dropped samples, the
row is left out for all. Means of white noise are as good as its samples for what is done next, which is averaging over
rests; a log of an hour becomes a table that can be held.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.message import joined, say, say_count
from estimator.session import ACCELEROMETER, GYROSCOPE
from estimator.wording import counted
from service.kit.limits import check_table, refusal

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stream:
    """One instance of an accelerometer or a gyro with three axes, in the order measured."""

    label: str
    """What the log calls it, with its instance."""
    kind: str
    """`accelerometer` or `gyroscope`."""
    time: Array
    """(n,) s, since any start that all streams of the log share."""
    values: Array
    """(n, 3) m/s² or rad/s."""
    temperature: Array | None = None
    """(n,) °C, where it is measured."""

    @property
    def unit(self) -> str:
        """Of its values."""
        return "m/s²" if self.kind == ACCELEROMETER else "rad/s"


def in_order(stream: Stream) -> Stream:
    """Without samples that are no numbers, by time: of two clocks in one log one may lag behind."""
    sound = np.isfinite(stream.time) & np.isfinite(stream.values).all(axis=1)
    order = np.flatnonzero(sound)[np.argsort(stream.time[sound], kind="stable")]
    temperature = None if stream.temperature is None else stream.temperature[order]
    return Stream(stream.label, stream.kind, stream.time[order], stream.values[order], temperature)


RATE = 50.0
"""Rows a second at most: a rest of two seconds has a hundred, and a log of three IMUs lasts half an hour within the
usual limits."""
SAMPLES = 2.0
"""Of the slowest stream in a row, so that its jitter leaves no row empty."""
SLOWEST = 4.0
"""Samples a second of any stream at least: with fewer nobody sees when the block rests."""
FEWEST = 100
"""Samples below which a stream is not one that is logged all along."""
AXES = "xyz"


@dataclass(frozen=True)
class LogTable:
    """A log as a table that says itself what its columns are."""

    columns: dict[str, Array]
    """By heading."""
    meanings: tuple[str, ...]
    """What each column is read as."""
    facts: dict[str, object]
    """What it says of the session: imu-session/1 without its table."""


def log_table(streams: Sequence[Stream], filename: str, facts: dict[str, object]) -> LogTable:
    """All streams on one clock; FormatError where they have none in common, or there is no accelerometer."""
    sound = [in_order(stream) for stream in streams]
    ordered = [stream for stream in sound if len(stream.time) >= FEWEST]
    if not any(stream.kind == ACCELEROMETER for stream in ordered):
        raise refusal(
            filename,
            say("contains no accelerometer with at least {fewest} samples; log the raw IMU data", fewest=FEWEST),
            "table",
        )
    start = max(float(stream.time[0]) for stream in ordered)
    end = min(float(stream.time[-1]) for stream in ordered)
    slowest = min(map(_rate, ordered))
    if slowest < SLOWEST:
        raise refusal(
            filename,
            say(
                "has an IMU with {slowest} samples a second; at least {slowest2} are needed",
                slowest=f"{slowest:.3g}",
                slowest2=f"{SLOWEST:g}",
            ),
            "table",
        )
    rate = min(RATE, slowest / SAMPLES)
    rows = (end - start) * rate
    if rows < 1:
        raise refusal(filename, "has IMUs that were not logged at the same time; their times do not overlap", "table")
    check_table(filename, int(rows), 3 * len(ordered) + 2)
    table = _table(ordered, _Clock(start, round(rate, 3), int(rows)))
    notes = [str(facts.get("notes", "")), *_left_out(streams, sound), *_torn(len(table.columns["time [s]"]), int(rows))]
    said = joined(" ", filter(None, notes))
    return replace(table, facts={**facts, **table.facts, **({"notes": said} if said else {})})


def _left_out(streams: Sequence[Stream], sound: Sequence[Stream]) -> Iterator[str]:
    """What of a log is not in its table."""
    for stream, kept in zip(streams, sound, strict=True):
        if len(kept.time) < len(stream.time):
            gone = len(stream.time) - len(kept.time)
            yield say_count(
                "{label}: {n} sample without a number left out.",
                "{label}: {n} samples without a number left out.",
                gone,
                label=stream.label,
            )
        if len(kept.time) < FEWEST:
            yield say(
                "{label} has {time} only and was left out.", label=stream.label, time=counted(len(kept.time), "sample")
            )


def _torn(kept: int, rows: int) -> Iterator[str]:
    if kept < rows:
        yield say("{rows} of {rows2} rows left out: an IMU has no data there.", rows=rows - kept, rows2=rows)


def _rate(stream: Stream) -> float:
    """Samples a second; of two at one time each counts."""
    steps = np.diff(stream.time)
    usual = float(np.median(steps[steps > 0])) if np.any(steps > 0) else 1.0
    return 1.0 / usual


@dataclass(frozen=True)
class _Clock:
    """Spans of time of equal length."""

    start: float
    rate: float
    rows: int

    def means(self, stream: Stream, values: Array) -> Array:
        """(rows, k) means of the values (n, k) that lie in each span; NaN where none does."""
        span = np.floor((stream.time - self.start) * self.rate)
        inside = (span >= 0) & (span < self.rows)
        place = span[inside].astype(np.int64)
        count = np.bincount(place, minlength=self.rows).astype(float)
        count[count == 0] = np.nan
        sums = [np.bincount(place, column, self.rows) for column in values[inside].T]
        means: Array = np.column_stack(sums) / count[:, None]
        return means

    @property
    def times(self) -> Array:
        """(rows,) middles of the spans, s since the first began."""
        times: Array = (np.arange(self.rows, dtype=np.float64) + 0.5) / self.rate
        return times


def _table(streams: Sequence[Stream], clock: _Clock) -> LogTable:
    columns, meanings, sensors = {"time [s]": clock.times}, ["time_s"], []
    for kind, letter in ((ACCELEROMETER, "A"), (GYROSCOPE, "G")):
        own = [stream for stream in streams if stream.kind == kind]
        for place, stream in enumerate(own):
            means = clock.means(stream, stream.values)
            for axis, name in enumerate(AXES):
                columns[f"{stream.label} {name} [{stream.unit}]"] = means[:, axis]
                meanings.append(f"{letter}{3 * place + axis + 1}")
                sensors.append(_sensor(meanings[-1], stream, axis))
    warm = next((stream for stream in streams if _is_warm(stream)), None)
    if warm is not None and warm.temperature is not None:
        columns[f"{warm.label} temperature [°C]"] = clock.means(warm, warm.temperature[:, None])[:, 0]
        meanings.append("temperature_c")
    whole = np.isfinite(np.column_stack(list(columns.values()))).all(axis=1)
    said = {"block": ACCELEROMETER, "programme": "arbitrary-orientations", "sample_rate_hz": clock.rate}
    kept = {heading: column[whole] for heading, column in columns.items()}
    return LogTable(kept, tuple(meanings), {**said, "sensors": sensors})


def _is_warm(stream: Stream) -> bool:
    """Whether it says its temperature, and not for ever nothing."""
    return stream.temperature is not None and bool(np.isfinite(stream.temperature).all())


def _sensor(name: str, stream: Stream, axis: int) -> dict[str, object]:
    """In SI and along the axes of the log: how it is calibrated is what the session will tell."""
    entry: dict[str, object] = {
        "name": name,
        "nominal_axis": [float(k == axis) for k in range(len(AXES))],
        "nominal_scale": 1.0,
        "reading_unit": stream.unit,
    }
    return entry | ({"kind": GYROSCOPE} if stream.kind == GYROSCOPE else {})
