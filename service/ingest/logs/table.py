"""Streams of several IMUs, each with its own times → common rows: means over equal spans of time.

A row is the mean of the samples within its span. Where a stream has none, because the log dropped samples, the row is
left out for all. For white noise, averages of means are as good as averages of samples, and averaging over rests is
what follows; a log of an hour becomes a table of moderate size.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.message import joined, say
from estimator.screening import Screen, Screening
from estimator.session import ACCELEROMETER, GYROSCOPE, Sensor
from estimator.wording import counted
from service.kit.limits import check_table, refusal

Array = NDArray[np.float64]


AXES = "xyz"
AXIS = Sensor("", ACCELEROMETER, np.eye(3)[0], 1.0, "")
"""A channel of a stream, but for its name and kind."""


@dataclass(frozen=True, eq=False)
class Stream:
    """One instance of an accelerometer or a gyro with three axes, in the order measured."""

    label: str
    """Name in the log, with its instance."""
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
        """Unit of its values."""
        return "m/s²" if self.kind == ACCELEROMETER else "rad/s"


def in_order(stream: Stream, declined: Collection[str] = ()) -> tuple[Stream, Screening]:
    """The stream's own readings, screened, by time: of two clocks in one log one may lag behind."""
    named = [replace(AXIS, name=f"{stream.label} {axis}", kind=stream.kind) for axis in AXES]
    screen = Screen(tuple(named), frozenset(declined), None)
    values = screen.readings(stream.values)
    sound = np.isfinite(stream.time) & np.isfinite(values).all(axis=1)
    order = np.flatnonzero(sound)[np.argsort(stream.time[sound], kind="stable")]
    temperature = None if stream.temperature is None else stream.temperature[order]
    return Stream(stream.label, stream.kind, stream.time[order], values[order], temperature), screen.findings


RATE = 50.0
"""Rows a second at most: a rest of two seconds has a hundred, and a log of three IMUs lasts half an hour within the
usual limits."""
SAMPLES = 2.0
"""Samples of the slowest stream in a row, so that its jitter leaves no row empty."""
SLOWEST = 4.0
"""Samples a second of any stream at least: with fewer a rest cannot be recognised."""
FEWEST = 100
"""Samples below which a stream counts as not logged throughout."""


@dataclass(frozen=True)
class LogTable:
    """A log as a table with the meaning of its columns."""

    columns: dict[str, Array]
    """Columns by heading."""
    meanings: tuple[str, ...]
    """Meaning of each column."""
    facts: dict[str, object]
    """Facts of the session stated in the log: imu-session/1 without its table."""
    screening: Screening = ()
    """Findings in the log's samples."""


def log_table(
    streams: Sequence[Stream], filename: str, facts: dict[str, object], declined: Collection[str] = ()
) -> LogTable:
    """All streams on one clock; FormatError where their times do not overlap, or there is no accelerometer."""
    screened = [in_order(stream, declined) for stream in streams]
    cleaned = [stream for stream, _ in screened]
    ordered = [stream for stream in cleaned if len(stream.time) >= FEWEST]
    if not any(stream.kind == ACCELEROMETER for stream in ordered):
        raise refusal(
            filename,
            "contains no accelerometer with at least {fewest} samples; log the raw IMU data",
            "table",
            fewest=FEWEST,
        )
    start = max(float(stream.time[0]) for stream in ordered)
    end = min(float(stream.time[-1]) for stream in ordered)
    slowest = min(map(_rate, ordered))
    if slowest < SLOWEST:
        raise refusal(
            filename,
            "has an IMU with {rate} samples a second; at least {lowest_rate} are needed",
            "table",
            rate=f"{slowest:.3g}",
            lowest_rate=f"{SLOWEST:g}",
        )
    rate = min(RATE, slowest / SAMPLES)
    rows = (end - start) * rate
    if rows < 1:
        raise refusal(filename, "has IMUs that were not logged at the same time; their times do not overlap", "table")
    check_table(filename, int(rows), 3 * len(ordered) + 2)
    table = _table(ordered, _Clock(start, round(rate, 3), int(rows)))
    notes = [
        str(facts.get("notes", "")),
        *_left_out(cleaned),
        *_torn(len(table.columns["time [s]"]), int(rows)),
    ]
    text = joined(" ", filter(None, notes))
    found = tuple(finding for _, findings in screened for finding in findings)
    return replace(table, facts={**facts, **table.facts, **({"notes": text} if text else {})}, screening=found)


def _left_out(cleaned: Sequence[Stream]) -> Iterator[str]:
    for clean in cleaned:
        if len(clean.time) < FEWEST:
            yield say(
                "{label} has {time} only and was left out.", label=clean.label, time=counted(len(clean.time), "sample")
            )


def _torn(row_count: int, rows: int) -> Iterator[str]:
    if row_count < rows:
        yield say("{number} of {rows} rows left out: an IMU has no data there.", number=rows - row_count, rows=rows)


def _rate(stream: Stream) -> float:
    """Samples a second; two samples at one time both count."""
    steps = np.diff(stream.time)
    interval = float(np.median(steps[steps > 0])) if np.any(steps > 0) else 1.0
    return 1.0 / interval


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
        streams_of_kind = [stream for stream in streams if stream.kind == kind]
        for place, stream in enumerate(streams_of_kind):
            means = clock.means(stream, stream.values)
            for axis, name in enumerate(AXES):
                columns[f"{stream.label} {name} [{stream.unit}]"] = means[:, axis]
                meanings.append(f"{letter}{3 * place + axis + 1}")
                sensors.append(_sensor(meanings[-1], stream, axis))
    warm_stream = next((stream for stream in streams if _is_warm(stream)), None)
    if warm_stream is not None and warm_stream.temperature is not None:
        columns[f"{warm_stream.label} temperature [°C]"] = clock.means(warm_stream, warm_stream.temperature[:, None])[
            :, 0
        ]
        meanings.append("temperature_c")
    is_complete = np.isfinite(np.column_stack(list(columns.values()))).all(axis=1)
    facts = {"block": ACCELEROMETER, "programme": "arbitrary-orientations", "sample_rate_hz": clock.rate}
    complete = {heading: column[is_complete] for heading, column in columns.items()}
    return LogTable(complete, tuple(meanings), {**facts, "sensors": sensors})


def _is_warm(stream: Stream) -> bool:
    """Whether it has a temperature throughout."""
    return stream.temperature is not None and bool(np.isfinite(stream.temperature).all())


def _sensor(name: str, stream: Stream, axis: int) -> dict[str, object]:
    """The entry of a sensor in SI and along the axes of the log: the session determines its calibration."""
    entry: dict[str, object] = {
        "name": name,
        "nominal_axis": [float(k == axis) for k in range(len(AXES))],
        "nominal_scale": 1.0,
        "reading_unit": stream.unit,
    }
    return entry | ({"kind": GYROSCOPE} if stream.kind == GYROSCOPE else {})
