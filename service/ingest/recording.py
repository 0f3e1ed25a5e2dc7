"""In the reading process: the parts of a recording, its checked head first, then its readings as numbers."""

from collections.abc import Iterator
from pathlib import Path

import polars as pl

from estimator.message import say
from estimator.reading import read_session
from estimator.session import CalibrationSession
from service.ingest.log_rows import UNREADABLE, Rows, numbers, rows_of
from service.ingest.metadata import with_metadata
from service.ingest.parquet import columns_of
from service.kit.limits import check_table, in_force, refusal

HEAD = 100
"""Rows that are read and checked like a whole session."""


def recording(path: Path, filename: str) -> Iterator[object]:
    """The session of the first rows, then (R, sensors) readings, some rows at a time; what is missing is NaN."""
    rows = rows_of(path, filename)
    if rows is None:
        raise refusal(filename, "is neither CSV with # lines nor Parquet")
    check_table(filename, 1, len(rows.names))
    head = _head(rows, filename)
    yield head
    names = [sensor.name for sensor in head.sensors]
    for frame in _frames(rows, names, filename):
        yield frame.to_numpy()


def _head(rows: Rows, filename: str) -> CalibrationSession:
    try:
        first = next(rows.stretches(rows.names), pl.DataFrame()).head(HEAD)
    except UNREADABLE as error:
        raise refusal(filename, say("cannot be read as a table: {error}", error=str(error)[:200]), "table") from error
    first = first.with_columns(numbers(column) for column in first if column.dtype == pl.String)
    document = with_metadata(rows.metadata, columns_of(first, filename), filename)
    return read_session(document, name=filename, part=True)


def _frames(rows: Rows, names: list[str], filename: str) -> Iterator[pl.DataFrame]:
    """Numbers alone."""
    columns, most, at = len(rows.names), in_force().log_cells, 0
    try:
        for frame in rows.stretches(names):
            at += len(frame)
            if at * columns > most:
                raise refusal(
                    filename, say("has more than {most} cells, the most of a recording; split it", most=most), "table"
                )
            yield frame.cast(pl.Float64)
    except UNREADABLE as error:
        raise refusal(filename, say("cannot be read to its end: {error}", error=str(error)[:200]), "table") from error
