"""A raw log of more cells than may be held, as CSV or Parquet: averaged while it is scanned."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path
from typing import Protocol

import numpy as np
import polars as pl

from estimator.calibration.free import residual_per_freedom
from estimator.errors import FormatError, Problem, ScheduleError, SessionError
from estimator.long_logs import LongLog, average_long
from estimator.message import say
from estimator.reading import Extent, read_session
from estimator.reading.csv_text import cell_of
from estimator.reading.keys import COLUMNS
from estimator.session import CALIBRATIONS, Array, CalibrationSession
from service.ingest.apart import teller
from service.ingest.formats import PARQUET, may_be_log
from service.ingest.metadata import KEY, with_metadata
from service.ingest.parquet import columns_of
from service.kit.limits import check_table, in_force, refusal

LONGEST_HEADER = 1024 * 1024
"""Bytes of # lines, and of the header, before the rows of a CSV file."""
STRETCH = 2 * 1024 * 1024
"""Bytes of a CSV that are read at a time: far more than a line, and its numbers are not much larger."""
CHUNK = 250_000
"""Cells of a Parquet file that are asked for at a time: some megabytes."""
SEEN = 1_000
"""Rows by which it is decided whether a column of a CSV holds numbers."""
SEPARATORS = ",;\t"
"""Of columns; the one that the header has most of is taken."""
UNREADABLE = (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError)
"""What polars raises for damaged files."""
START = 4096
"""Bytes by which a file is told: blank lines may come first."""
PARQUET_DAMAGED = "is damaged or not a readable Parquet file; write it again"


class Rows(Protocol):
    """A table, and how to go through it."""

    @property
    def metadata(self) -> str:
        """The JSON text that stands beside the table."""

    @property
    def names(self) -> Sequence[str]:
        """Of all columns."""

    def count(self, most: int) -> int:
        """Rows; more than ``most`` may be left uncounted."""

    def stretches(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        """Some columns, some rows at a time; polars' errors where the table is not as it should be."""


def rows_of(path: Path, filename: str) -> Rows | None:
    """The table of a CSV or Parquet file; None of any other."""
    with path.open("rb") as file:
        start = file.read(START)
    if not may_be_log(start):
        return None
    return parquet_rows(path, filename) if start.startswith(PARQUET) else csv_rows(path, filename)


@dataclass(frozen=True)
class ParquetRows:
    """Of a Parquet file, whose row groups are unpacked one after another."""

    path: Path
    filename: str
    metadata: str
    names: Sequence[str]

    def count(self, most: int) -> int:
        """As the file says."""
        return int(pl.scan_parquet(self.path).select(pl.len()).collect().item())

    def stretches(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        """One slice after another, for which only the row groups are unpacked that it lies in."""
        table, at = pl.scan_parquet(self.path).select(names), 0
        rows, whole, size = max(CHUNK // len(self.names), 1), max(self.count(0), 1), self.path.stat().st_size
        while len(frame := table.slice(at, rows).collect()):
            yield frame
            at += len(frame)
            teller().at(size * at // whole, size)


def parquet_rows(path: Path, filename: str) -> ParquetRows:
    """The table of a Parquet file; FormatError where it is none."""
    try:
        metadata = pl.read_parquet_metadata(path).get(KEY)
        names = pl.scan_parquet(path).collect_schema().names()
    except UNREADABLE as error:
        raise refusal(filename, PARQUET_DAMAGED) from error
    if metadata is None:
        raise refusal(
            filename, say("has no key-value entry {key}; put the session's JSON without its table there", key=KEY)
        )
    return ParquetRows(path, filename, metadata, names)


@dataclass(frozen=True)
class CsvRows:
    """Of a CSV file with its metadata in # lines."""

    path: Path
    metadata: str
    names: Sequence[str]
    separator: str
    begins: int
    """Byte of the first row."""
    texts: frozenset[str] = frozenset()
    """Columns that do not hold numbers."""

    def count(self, most: int) -> int:
        """By the ends of lines."""
        rows = 0
        for text in self._stretches():
            rows += text.count(b"\n") + (not text.endswith(b"\n"))
            if rows > most:
                break
        return rows

    def stretches(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        """One of the file after another; a column that should hold numbers and does not comes as texts."""
        size, done = self.path.stat().st_size, self.begins
        for text in self._stretches():
            yield self._read(text, names)
            done += len(text)
            teller().at(done, size)

    def _read(self, text: bytes, names: Sequence[str]) -> pl.DataFrame:
        """Whole lines; numbers with blanks around them take the longer way, and what is wrong with others is kept."""
        try:
            return self._as(text, names, self.texts)
        except pl.exceptions.ComputeError:
            written = self._as(text, names, frozenset(names))
            return written.select(numbers(written[name]) if name not in self.texts else name for name in names)

    def _as(self, text: bytes, names: Sequence[str], texts: frozenset[str]) -> pl.DataFrame:
        kinds = {name: pl.String if name in texts else pl.Float64 for name in self.names}
        table = pl.scan_csv(text, has_header=False, separator=self.separator, schema=kinds, infer_schema=False)
        return table.select(names).collect()

    def _stretches(self) -> Iterator[bytes]:
        """Whole lines, some megabytes at a time."""
        with self.path.open("rb") as file:
            file.seek(self.begins)
            while text := file.read(STRETCH):
                yield text if text.endswith(b"\n") else text + file.readline(STRETCH)


def csv_rows(path: Path, filename: str) -> CsvRows:
    """The table of a CSV file; FormatError where it has none."""
    with path.open("rb") as file:
        start = file.read(LONGEST_HEADER).removeprefix(b"\xef\xbb\xbf")
        marked = 3 if file.seek(0) == 0 and file.read(3) == b"\xef\xbb\xbf" else 0
    lines = start.split(b"\n")[:-1]
    leading = list(takewhile(lambda line: line.startswith(b"#") or not line.strip(), lines))
    if len(leading) == len(lines):
        raise refusal(filename, "has no table after its # lines", "table")
    header = lines[len(leading)]
    try:
        metadata = "\n".join(line.decode()[1:] for line in leading)
        separator = max(SEPARATORS, key=header.decode().count)
        names = [name.strip().strip('"') for name in header.decode().split(separator)]
    except UnicodeDecodeError as error:
        raise refusal(
            filename, say("is not UTF-8 text (byte {start}); save it as UTF-8", start=error.start + 1)
        ) from error
    if len(set(names)) < len(names) or not all(names):
        raise refusal(filename, "has columns without a name or of the same name; names must differ", "table")
    begins = marked + sum(len(line) + 1 for line in lines[: len(leading) + 1])
    rows = CsvRows(path, metadata, names, separator, begins, frozenset(names))
    try:
        first = next(rows.stretches(names), pl.DataFrame()).head(SEEN)
    except UNREADABLE as error:
        raise refusal(filename, say("cannot be read as a table: {error}", error=error), "table") from error
    texts = frozenset(name for name in first.columns if numbers(first[name]).dtype == pl.String)
    return CsvRows(path, metadata, names, separator, begins, texts)


def numbers(texts: pl.Series) -> pl.Series:
    """As numbers where all are, else as they are."""
    stripped = texts.str.strip_chars()
    stripped = stripped.set(stripped == "", None)
    numbers = stripped.cast(pl.Float64, strict=False)
    return texts if numbers.null_count() > stripped.null_count() else numbers


LABEL, SETTINGS = "position", ("beta_deg", "run")
"""Columns that say where the block stood."""


def averaged_if_long(path: Path, filename: str) -> CalibrationSession | None:
    """The averaged positions of a long raw log in a file; None of any other file, which is read whole."""
    rows = rows_of(path, filename)
    if rows is None:
        return None
    most, columns = in_force(), len(rows.names)
    document = with_metadata(rows.metadata, {}, filename)
    if document.get("sample_rate_hz") is None or document.get("programme") not in CALIBRATIONS:
        return None
    if rows.count(most.cells // columns) * columns <= most.cells:
        return None
    check_table(filename, 1, columns)
    try:
        return _averaged(_Scan(rows, document, filename))
    except SessionError as fault:
        kind = ScheduleError if isinstance(fault, ScheduleError) else FormatError
        raise kind(fault.problems, filename) from fault


@dataclass
class _Codes:
    """Names of positions or runs as numbers, by first appearance; -1 of none."""

    known: dict[str, int] = field(default_factory=dict)

    def of(self, series: pl.Series) -> Array:
        """(r,) numbers as they are, names numbered."""
        if series.dtype.is_numeric():
            return series.cast(pl.Float64).fill_null(-1).to_numpy()
        names = series.cast(pl.String).fill_null("").str.strip_chars()
        codes = {name: self._code(name) for name in names.unique(maintain_order=True)}
        return names.replace_strict(codes, return_dtype=pl.Float64).to_numpy()

    def _code(self, name: str) -> int:
        return -1 if name in ("", "-1") else self.known.setdefault(name, len(self.known))


@dataclass(frozen=True)
class _Scan:
    """One log, gone through as often as its averages need it."""

    rows: Rows
    document: Mapping[str, object]
    """Without its table."""
    filename: str

    def parts(self) -> Iterator[CalibrationSession]:
        """Some rows at a time, checked as those of any session."""
        codes, at = _Codes(), 0
        for frame in self._frames(self._needed()):
            yield self._checked(self._table(frame, codes), at)
            at += len(frame)

    def labels(self) -> Callable[[], Iterator[Array]] | None:
        """What labels the rows: a position, else the settings of a stand, else nothing."""
        names = [LABEL] if LABEL in self.rows.names else [name for name in SETTINGS if name in self.rows.names]
        return (lambda: self._settings(names)) if names else None

    def _settings(self, names: list[str]) -> Iterator[Array]:
        codes = [_Codes() for _ in names]
        for frame in self._frames(names):
            yield np.column_stack([code.of(frame[name]) for code, name in zip(codes, names, strict=True)])

    def check_names(self) -> None:
        """Raises for what is wrong with the first rows, columns that belong to nothing among it."""
        for frame in self._frames(self.rows.names):
            self._checked(self._table(frame.head(1), _Codes()), 0)
            return

    def _table(self, frame: pl.DataFrame, codes: _Codes) -> dict[str, object]:
        """Columns as a session file has them."""
        table = columns_of(frame, self.filename)
        for name in frame.columns:
            if name == LABEL:
                table[name] = codes.of(frame[name])
            elif frame[name].dtype == pl.String:
                table[name] = [cell_of(text or "") for text in frame[name]]
        return table

    def _needed(self) -> list[str]:
        """Columns that say something of a session; others are looked at once, by their names."""
        sensors = self.document.get("sensors")
        own = [one.get("name") for one in sensors if isinstance(one, dict)] if isinstance(sensors, list) else []
        known = {*COLUMNS, *own, *(f"{name}_se" for name in own)}
        return [name for name in self.rows.names if name in known]

    def _frames(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        columns, most, at = len(self.rows.names), in_force().log_cells, 0
        try:
            for frame in ahead(self.rows.stretches(names)):
                at += len(frame)
                if at * columns > most:
                    raise refusal(
                        self.filename,
                        say("has more than {most} cells, the limit for a raw log; split it", most=most),
                        "table",
                    )
                if len(frame):
                    yield frame
        except UNREADABLE as error:
            raise refusal(
                self.filename, say("cannot be read to its end: {error}", error=str(error)[:200]), "table"
            ) from error

    def _checked(self, table: Mapping[str, object], at: int) -> CalibrationSession:
        """The rows from ``at`` on; every problem names its row of the whole log."""
        try:
            return read_session({**self.document, "table": table}, name=self.filename, most=Extent(), part=True)
        except FormatError as fault:
            found = [Problem(one.field, one.message, one.row and one.row + at) for one in fault.problems]
            raise FormatError(found, self.filename) from fault


def ahead(frames: Iterator[pl.DataFrame]) -> Iterator[pl.DataFrame]:
    """The same, the next of them being read while one is worked on."""
    with ThreadPoolExecutor(1) as reader:
        coming = reader.submit(next, frames, None)
        while (frame := coming.result()) is not None:
            coming = reader.submit(next, frames, None)
            yield frame


def _averaged(scan: _Scan) -> CalibrationSession:
    scan.check_names()
    return average_long(LongLog(scan.parts, scan.labels()), residual_per_freedom)
