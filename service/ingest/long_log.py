"""A raw log of more cells than may be held, as CSV or Parquet: averaged while it is scanned."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

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
from service.ingest.log_rows import UNREADABLE, Rows, rows_of
from service.ingest.metadata import with_metadata
from service.ingest.parquet import columns_of
from service.kit.limits import check_table, in_force, refusal

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
                        say("has more than {most} cells, the most of a raw log; split it", most=most),
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
