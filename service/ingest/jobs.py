"""Jobs of a reading process, by name. Only that process loads the libraries of the formats."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import polars as pl

from estimator.json_object import Json
from estimator.reading import read_session
from estimator.reading.problems import Where
from estimator.screening import Screen
from estimator.session import CalibrationSession
from service.ingest import hdf5, mat, parquet, xlsx
from service.ingest.formats import HDF5, LOGS, MAT, PARQUET, XLSX, is_binary, start_of
from service.ingest.layout.decoding import SAMPLE_BYTES
from service.ingest.layout.envelope import StoredTable, is_wrapped, unwrapped
from service.ingest.layout.look import lines, look
from service.ingest.layout.mapping import layout_of
from service.ingest.layout.reading import document_of
from service.ingest.layout.sampling import Sample, sample_of
from service.ingest.logs import log_of
from service.ingest.long_log import START, UNREADABLE, TableScan, averaged_if_long, numbers, rows_of
from service.ingest.metadata import with_metadata
from service.ingest.parquet import columns_of
from service.kit.limits import check_table, in_force, refusal

HEAD = 100
"""Rows that are read and checked like a whole session."""


def recording(path: Path, filename: str) -> Iterator[object]:
    """The session of the first rows, then (R, sensors) readings, some rows at a time; a missing reading is NaN."""
    rows = rows_of(path, filename)
    if rows is None:
        raise refusal(filename, "is neither CSV with # lines nor Parquet")
    check_table(filename, 1, len(rows.names))
    head = _head(rows, filename)
    yield head
    names = [sensor.name for sensor in head.sensors]
    screen = Screen(head.sensors, frozenset(head.unscreened), head.sample_rate, in_service=True)
    for frame in _frames(rows, names, filename):
        yield frame.to_numpy() if head.sample_rate is None else screen.readings(frame.to_numpy())


def _head(rows: TableScan, filename: str) -> CalibrationSession:
    try:
        frame = next(rows.stretches(rows.names), pl.DataFrame()).head(HEAD)
    except UNREADABLE as error:
        raise refusal(filename, "cannot be read as a table: {error}", "table", error=str(error)[:200]) from error
    frame = frame.with_columns(numbers(column) for column in frame if column.dtype == pl.String)
    document = with_metadata(rows.metadata, columns_of(frame, filename), filename)
    return read_session(document, name=filename, part=True)


def _frames(rows: TableScan, names: list[str], filename: str) -> Iterator[pl.DataFrame]:
    columns, limit, rows_read = len(rows.names), in_force().log_cells, 0
    try:
        for frame in rows.stretches(names):
            rows_read += len(frame)
            if rows_read * columns > limit:
                raise refusal(
                    filename, "has more than {limit} cells, the limit for a recording; split it", "table", limit=limit
                )
            yield frame.cast(pl.Float64)
    except UNREADABLE as error:
        raise refusal(filename, "cannot be read to its end: {error}", "table", error=str(error)[:200]) from error


Content = bytes | Path
"""Bytes of a file, or its path."""
Reader = Callable[[bytes, str], dict[str, object]]

NO_MAPPING = (
    "is a log, which does not state its unit or place: choose it on the upload page, or send it with a mapping, which "
    "POST /api/v1/layouts/preview proposes"
)

READERS: tuple[tuple[bytes, Reader], ...] = (
    (PARQUET, parquet.read_parquet),
    (XLSX, xlsx.read_xlsx),
    (HDF5, hdf5.read_hdf5),
    (MAT, mat.read_mat),
)
"""First bytes of a binary format, and what reads it; anything else is JSON or CSV, or refused as neither."""


def session(content: Content, filename: str, mapping: Json | None = None) -> object:
    """The checked session of a file of any format; of a long raw log its averaged positions."""
    averaged = averaged_if_long(content, filename, mapping) if isinstance(content, Path) else None
    return _read(_whole(content, filename), filename, mapping) if averaged is None else averaged


def first_rows(content: Content, filename: str, mapping: Json | None = None) -> object:
    """The first rows of a session, checked except for whether they are enough for its programme."""
    sample = None if mapping is None else _sample(content)
    return _read(_whole(content, filename) if sample is None else sample.head, filename, mapping, part=True)


def _read(content: bytes, filename: str, mapping: Json | None = None, *, part: bool = False) -> object:
    if is_wrapped(content):
        mapping, content = unwrapped(content, filename)
    if mapping is not None:
        document, where, found = document_of(content, filename, layout_of(mapping, filename), part=part)
        session = read_session(document, name=filename, most=in_force().extent, part=part, where=where)
        return replace(session, screening=(*found, *session.screening))
    if content.startswith(XLSX):
        document, where = xlsx.read_with_places(content, filename)
        if part:
            document, where = _measured(document, where)
        return read_session(document, name=filename, most=in_force().extent, part=part, where=where)
    for magic, read in READERS:
        if content.startswith(magic):
            return read_session(read(content, filename), name=filename, most=in_force().extent, part=part)
    if content.startswith(LOGS):
        log_of(content, filename)
        raise refusal(filename, NO_MAPPING)
    return read_session(content, name=filename, most=in_force().extent, part=part)


def _measured(document: dict[str, object], where: Where) -> tuple[dict[str, object], Where]:
    """The document without the rows of a workbook that are yet to be measured."""
    table, sensors = document.get("table"), document.get("sensors")
    if not isinstance(table, dict) or not isinstance(sensors, list) or document.get("sample_rate_hz") is not None:
        return document, where
    read = [table[name] for one in sensors if isinstance(one, dict) and (name := one.get("name")) in table]
    rows = [j for j, cells in enumerate(zip(*read, strict=False)) if any(cell is not None for cell in cells)]
    kept = {name: [cells[j] for j in rows if j < len(cells)] for name, cells in table.items()}
    return {**document, "table": kept}, lambda field, row: where(field, row and rows[row - 1] + 1)


def _sample(content: Content) -> Sample | None:
    """The first and some later rows of a long text; None of any other file."""
    if isinstance(content, bytes) or is_binary(start_of(content, START)):
        return None
    return sample_of(StoredTable(content, 0, content.stat().st_size))


def _whole(content: Content, filename: str) -> bytes:
    if isinstance(content, bytes):
        return content
    size, limit = content.stat().st_size, in_force().whole
    if size > limit:
        raise refusal(
            filename,
            "has {size} bytes; but for raw logs (sample_rate_hz) at most {limit} can be read",
            size=f"{size:,}",
            limit=f"{limit:,}",
        )
    return content.read_bytes()


def mat_matrices(content: Content, filename: str, _: Json | None = None) -> object:
    """All variables of a MAT file, with up to three rows or columns."""
    return mat.variables(_whole(content, filename), filename, most_rows=3)


def look_at(content: Content, filename: str, mapping: Json | None = None) -> object:
    """Preview of a table of custom layout."""
    return look(_sample(content) or _whole(content, filename), filename, mapping)


def lines_of(content: Content, filename: str, mapping: Json | None = None) -> object:
    """Beginning of a text that cannot be cut as it is understood."""
    return lines(start_of(content, SAMPLE_BYTES), filename, mapping)


JOBS: dict[str, Callable[[Content, str, Json | None], object]] = {
    "session": session,
    "first-rows": first_rows,
    "look": look_at,
    "lines": lines_of,
    "mat-matrices": mat_matrices,
}
"""Name → function."""
PARTED: dict[str, Callable[[Path, str], Iterator[object]]] = {"recording": recording}
"""Jobs that answer in parts, by name."""
