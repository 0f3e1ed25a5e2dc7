"""A raw log with more cells than the limit, as CSV or Parquet: averaged while it is scanned."""

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from itertools import takewhile
from pathlib import Path
from typing import Protocol

import numpy as np
import polars as pl

from estimator.calibration.free import residual_per_freedom, tilt_response
from estimator.errors import FormatError, ScheduleError, SessionError
from estimator.json_object import Json
from estimator.long_logs import LongLog, average_long
from estimator.reading import Extent, read_session
from estimator.reading.csv_text import cell_of
from estimator.reading.keys import COLUMNS
from estimator.reading.problems import Problems
from estimator.screening import Screen, Screening
from estimator.session import CALIBRATIONS, Array, CalibrationSession
from service.ingest.apart import progress_reporter
from service.ingest.formats import PARQUET, may_be_log
from service.ingest.layout.envelope import StoredTable, is_wrapped, table_in
from service.ingest.layout.mapping import layout_of
from service.ingest.layout.scanning import TextRows, long_text
from service.ingest.metadata import KEY, with_metadata
from service.ingest.parquet import columns_of
from service.kit.limits import check_table, in_force, refusal

LONGEST_HEADER = 1024 * 1024
"""Bytes of # lines, and of the header, before the rows of a CSV file."""
CHUNK_BYTES = 2 * 1024 * 1024
"""Bytes of a CSV that are read at a time: far more than a line, and its numbers are not much larger."""
CHUNK_CELLS = 250_000
"""CellKind of a Parquet file that are read at a time: some megabytes."""
SAMPLE_ROWS = 1_000
"""Rows from which it is decided whether a column of a CSV is numeric."""
SEPARATORS = ",;\t"
"""Possible separators of columns; the most frequent in the header is taken."""
UNREADABLE = (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError)
"""Raised by polars for damaged files."""
START = 4096
"""Bytes from which the format is recognised: blank lines may come first."""
PARQUET_DAMAGED = "is damaged or not a readable Parquet file; write it again"


class TableScan(Protocol):
    """A table that can be read in several passes."""

    @property
    def metadata(self) -> str:
        """The JSON text that accompanies the table."""

    @property
    def names(self) -> Sequence[str]:
        """Names of all columns."""

    def count(self, most: int) -> int:
        """Number of rows; counting may stop above ``most``."""

    def stretches(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        """Some columns, some rows at a time; polars' errors for a malformed table."""

    def where(self, field: str, row: int | None) -> str:
        """Place in the file of a field in one of the last rows; empty where unknown."""


def rows_of(path: Path, filename: str) -> TableScan | None:
    """The table of a CSV or Parquet file; None for any other."""
    with path.open("rb") as file:
        head = file.read(START)
    if not may_be_log(head):
        return None
    return parquet_rows(path, filename) if head.startswith(PARQUET) else csv_rows(path, filename)


def mapped_rows(path: Path, filename: str, mapping: Json | None) -> TextRows | None:
    """The rows of a long text under its mapping, be that in the file or beside it; None for any other table."""
    table = StoredTable(path, 0, path.stat().st_size)
    if mapping is None:
        mapping, table = table_in(path, filename)
    return long_text(table, filename, layout_of(mapping, filename))


@dataclass(frozen=True)
class ParquetRows:
    """Rows of a Parquet file, whose row groups are unpacked one after another."""

    path: Path
    filename: str
    metadata: str
    names: Sequence[str]

    def count(self, most: int) -> int:
        """The number of rows, as stated in the file."""
        return int(pl.scan_parquet(self.path).select(pl.len()).collect().item())

    def stretches(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        """One slice after another; only the row groups of the slice are unpacked."""
        table, rows_read = pl.scan_parquet(self.path).select(names), 0
        rows, total, size = max(CHUNK_CELLS // len(self.names), 1), max(self.count(0), 1), self.path.stat().st_size
        while len(frame := table.slice(rows_read, rows).collect()):
            yield frame
            rows_read += len(frame)
            progress_reporter().report(size * rows_read // total, size)

    def where(self, field: str, row: int | None) -> str:
        """Nothing: the row is named already."""
        return ""


def parquet_rows(path: Path, filename: str) -> ParquetRows:
    """The table of a Parquet file; FormatError where there is none."""
    try:
        metadata = pl.read_parquet_metadata(path).get(KEY)
        names = pl.scan_parquet(path).collect_schema().names()
    except UNREADABLE as error:
        raise refusal(filename, PARQUET_DAMAGED) from error
    if metadata is None:
        raise refusal(filename, "has no key-value entry {key}; put the session's JSON without its table there", key=KEY)
    return ParquetRows(path, filename, metadata, names)


@dataclass(frozen=True)
class CsvRows:
    """Rows of a CSV file with its metadata in # lines."""

    path: Path
    metadata: str
    names: Sequence[str]
    separator: str
    begins: int
    """Byte of the first row."""
    texts: frozenset[str] = frozenset()
    """Columns that are not numeric."""

    def count(self, most: int) -> int:
        """The number of rows, counted by line ends."""
        rows = 0
        for text in self._stretches():
            rows += text.count(b"\n") + (not text.endswith(b"\n"))
            if rows > most:
                break
        return rows

    def stretches(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        """One part of the file after another; a column that should be numeric and is not comes as texts."""
        size, done = self.path.stat().st_size, self.begins
        for text in self._stretches():
            yield self._read(text, names)
            done += len(text)
            progress_reporter().report(done, size)

    def where(self, field: str, row: int | None) -> str:
        """Nothing: the row is named already."""
        return ""

    def _read(self, text: bytes, names: Sequence[str]) -> pl.DataFrame:
        """Whole lines; numbers with blanks around them are parsed separately, and invalid ones are kept as texts."""
        try:
            return self._as(text, names, self.texts)
        except pl.exceptions.ComputeError:
            texts_only = self._as(text, names, frozenset(names))
            return texts_only.select(numbers(texts_only[name]) if name not in self.texts else name for name in names)

    def _as(self, text: bytes, names: Sequence[str], texts: frozenset[str]) -> pl.DataFrame:
        kinds = {name: pl.String if name in texts else pl.Float64 for name in self.names}
        table = pl.scan_csv(text, has_header=False, separator=self.separator, schema=kinds, infer_schema=False)
        return table.select(names).collect()

    def _stretches(self) -> Iterator[bytes]:
        """Whole lines, some megabytes at a time."""
        with self.path.open("rb") as file:
            file.seek(self.begins)
            while text := file.read(CHUNK_BYTES):
                yield text if text.endswith(b"\n") else text + file.readline(CHUNK_BYTES)


def csv_rows(path: Path, filename: str) -> CsvRows:
    """The table of a CSV file; FormatError where it has none."""
    with path.open("rb") as file:
        head = file.read(LONGEST_HEADER).removeprefix(b"\xef\xbb\xbf")
        mark_bytes = 3 if file.seek(0) == 0 and file.read(3) == b"\xef\xbb\xbf" else 0
    lines = head.split(b"\n")[:-1]
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
            filename, "is not UTF-8 text (byte {position}); save it as UTF-8", position=error.start + 1
        ) from error
    if len(set(names)) < len(names) or not all(names):
        raise refusal(filename, "has columns without a name or of the same name; names must differ", "table")
    begins = mark_bytes + sum(len(line) + 1 for line in lines[: len(leading) + 1])
    rows = CsvRows(path, metadata, names, separator, begins, frozenset(names))
    try:
        sample = next(rows.stretches(names), pl.DataFrame()).head(SAMPLE_ROWS)
    except UNREADABLE as error:
        raise refusal(filename, "cannot be read as a table: {error}", "table", error=error) from error
    texts = frozenset(name for name in sample.columns if numbers(sample[name]).dtype == pl.String)
    return CsvRows(path, metadata, names, separator, begins, texts)


def numbers(texts: pl.Series) -> pl.Series:
    """The texts as numbers where all are numeric, else unchanged."""
    stripped = texts.str.strip_chars()
    stripped = stripped.set(stripped == "", None)
    numbers = stripped.cast(pl.Float64, strict=False)
    return texts if numbers.null_count() > stripped.null_count() else numbers


LABEL, SETTINGS = "position", ("beta_deg", "run")
"""Columns of the block's orientation."""


def averaged_if_long(path: Path, filename: str, mapping: Json | None = None) -> CalibrationSession | None:
    """The averaged positions of a long raw log in a file; all rows of a long text under a mapping that is short enough
    to be averaged in one piece; None for any other file."""
    is_mapped = mapping is not None or is_wrapped(path)
    rows = mapped_rows(path, filename, mapping) if is_mapped else rows_of(path, filename)
    if rows is None:
        return None
    limits, columns = in_force(), len(rows.names)
    document = with_metadata(rows.metadata, {}, filename)
    if document.get("sample_rate_hz") is None or document.get("programme") not in CALIBRATIONS:
        return None
    if rows.count(limits.cells // columns) * columns <= limits.cells:
        return _whole(rows, document, filename) if isinstance(rows, TextRows) else None
    check_table(filename, 1, columns)
    try:
        return _averaged(_Scan(rows, document, filename))
    except SessionError as fault:
        kind = ScheduleError if isinstance(fault, ScheduleError) else FormatError
        raise kind(fault.problems, filename) from fault


def _whole(rows: TextRows, document: Mapping[str, object], filename: str) -> CalibrationSession:
    """A log that is averaged in one piece, cut some rows at a time, which takes less memory."""
    rows = replace(rows, places=deque())
    frame = pl.concat(rows.stretches(rows.names), how="vertical_relaxed")
    table = columns_of(frame, filename)
    for name in (name for name in frame.columns if frame[name].dtype == pl.String):
        table[name] = [cell_of(text or "") for text in frame[name]]
    return read_session({**document, "table": table}, name=filename, most=in_force().extent, where=rows.where)


@dataclass
class _Codes:
    """Names of positions or runs as numbers, by first appearance; -1 for none."""

    known: dict[str, int] = field(default_factory=dict)

    def of(self, series: pl.Series) -> Array:
        """(r,) numbers unchanged, names numbered."""
        if series.dtype.is_numeric():
            return series.cast(pl.Float64).fill_null(-1).to_numpy()
        names = series.cast(pl.String).fill_null("").str.strip_chars()
        codes = {name: self._code(name) for name in names.unique(maintain_order=True)}
        return names.replace_strict(codes, return_dtype=pl.Float64).to_numpy()

    def _code(self, name: str) -> int:
        return -1 if name in ("", "-1") else self.known.setdefault(name, len(self.known))


@dataclass
class _Passage:
    """Properties of a log as a whole, found by passages through it."""

    signs: dict[str, int] = field(default_factory=dict)
    screening: Screening = ()
    """Findings of the last whole passage."""
    stands: bool = False
    """Whether the times never advance."""


@dataclass(frozen=True)
class _Scan:
    """One log, scanned as often as its averages need it."""

    rows: TableScan
    document: Mapping[str, object]
    """Session document without its table."""
    filename: str
    passage: _Passage = field(default_factory=_Passage)

    def parts(self) -> Iterator[CalibrationSession]:
        """Some rows at a time, screened and checked like those of any session."""
        codes, offset = _Codes(), 0
        screen: Screen | None = None
        for frame in self._frames(self._needed()):
            table = self._table(frame, codes)
            if screen is None:
                head = self._checked(self._table(frame.head(1), _Codes()), 0, None)
                screen = Screen(head.sensors, frozenset(head.unscreened), head.sample_rate, self.passage.signs)
            yield self._checked(table, offset, screen)
            offset += len(frame)
        if screen is not None:
            self._finish(screen)

    def _finish(self, screen: Screen) -> None:
        problems = Problems(self.filename)
        screen.check(problems.add)
        problems.raise_if_any()
        self.passage.stands = screen.clock_stands
        self.passage.signs, self.passage.screening = screen.signs, screen.findings

    def labels(self) -> Callable[[], Iterator[Array]] | None:
        """Labels of the rows: a position, else the settings of a stand, else none."""
        names = [LABEL] if LABEL in self.rows.names else [name for name in SETTINGS if name in self.rows.names]
        return (lambda: self._settings(names)) if names else None

    def _settings(self, names: list[str]) -> Iterator[Array]:
        codes = [_Codes() for _ in names]
        for frame in self._frames(names):
            yield np.column_stack([code.of(frame[name]) for code, name in zip(codes, names, strict=True)])

    def check_names(self) -> None:
        """Checks the first rows, with every column: raises for columns that belong to nothing."""
        for frame in self._frames(self.rows.names):
            self._checked(self._table(frame.head(1), _Codes()), 0, None)
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
        """Columns of a session; others are checked once, by their names."""
        sensors = self.document.get("sensors")
        names = [s.get("name") for s in sensors if isinstance(s, dict)] if isinstance(sensors, list) else []
        known = {*COLUMNS, *names, *(f"{name}_se" for name in names)}
        return [name for name in self.rows.names if name in known]

    def _frames(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        columns, limit, rows_read = len(self.rows.names), in_force().log_cells, 0
        try:
            for frame in ahead(self.rows.stretches(names)):
                rows_read += len(frame)
                if rows_read * columns > limit:
                    raise refusal(
                        self.filename,
                        "has more than {most} cells, the limit for a raw log; split it",
                        "table",
                        most=limit,
                    )
                if len(frame):
                    yield frame
        except UNREADABLE as error:
            raise refusal(
                self.filename, "cannot be read to its end: {error}", "table", error=str(error)[:200]
            ) from error

    def _checked(self, table: Mapping[str, object], offset: int, screen: Screen | None) -> CalibrationSession:
        """The rows from ``offset`` on; every problem names its row of the whole log."""
        whole = {**self.document, "table": table}
        return read_session(
            whole,
            name=self.filename,
            most=Extent(),
            part=True,
            rows_before=offset,
            screen=screen,
            where=self.rows.where,
        )


def ahead(frames: Iterator[pl.DataFrame]) -> Iterator[pl.DataFrame]:
    """The frames, reading the next one while one is processed."""
    with ThreadPoolExecutor(1) as reader:
        pending = reader.submit(next, frames, None)
        while (frame := pending.result()) is not None:
            pending = reader.submit(next, frames, None)
            yield frame


def _averaged(scan: _Scan) -> CalibrationSession:
    scan.check_names()
    log, signs = LongLog(scan.parts, scan.labels()), dict(scan.passage.signs)
    try:
        session = average_long(log, residual_per_freedom, tilt_response)
    except SessionError:
        if signs == scan.passage.signs:
            raise
        return _averaged(scan)
    if signs != scan.passage.signs:  # what a late part shows of all is taken into account from the first on
        return _averaged(scan)
    time = None if scan.passage.stands else session.time
    return replace(session, time=time, screening=(*scan.passage.screening, *session.screening))
