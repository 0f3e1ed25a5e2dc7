"""A recording of any length, chunk by chunk: Parquet and CSV are scanned, other formats are read whole."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from estimator.reading import read_session
from estimator.session import CalibrationSession
from service.ingest import parquet, read_upload
from service.ingest.formats import PARQUET
from service.ingest.limits import refusal
from service.ingest.metadata import KEY, with_metadata

Chunk = NDArray[np.float64]

HEAD = 100
"""Rows that are read and checked like a whole session."""
CHUNK = 50_000
"""Rows held at a time."""
LONGEST_HEADER = 1024 * 1024
"""Bytes of # lines before the table of a CSV file."""
SEPARATORS = ",;\t"
"""Of columns; the one that the header has most of is taken."""
UNREADABLE = (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError)
"""What polars raises for damaged files."""


@dataclass(frozen=True)
class Recording:
    """What a recording is, and its readings as they come."""

    head: CalibrationSession
    """The session of its first rows."""
    chunks: Iterator[Chunk]
    """(R, sensors) in the order measured; what is missing is NaN."""


def open_recording(path: Path) -> Recording:
    """The recording in a file; raises SessionError with every problem of its head."""
    with path.open("rb") as file:
        start = file.read(LONGEST_HEADER)
    if start.startswith(PARQUET):
        return _scanned(path, pl.scan_parquet(path), _parquet_metadata(path))
    if start.lstrip(b"\xef\xbb\xbf \r\n").startswith(b"#"):
        return _csv(path, start)
    session = read_upload(path.read_bytes(), str(path))
    return Recording(session, iter([session.readings]))


def _parquet_metadata(path: Path) -> str:
    try:
        metadata = pl.read_parquet_metadata(path).get(KEY)
    except UNREADABLE as error:
        raise refusal(str(path), "is damaged or not a readable Parquet file; write it again") from error
    if metadata is None:
        raise refusal(str(path), f"has no key-value entry {KEY}; put the session's JSON without its table there")
    return metadata


def _csv(path: Path, start: bytes) -> Recording:
    lines = start.decode("utf-8-sig", errors="replace").splitlines()
    leading = list(takewhile(lambda line: line.startswith("#") or not line.strip(), lines))
    if len(leading) == len(lines):
        raise refusal(str(path), "has no table after its # lines", "table")
    separator = max(SEPARATORS, key=lines[len(leading)].count)
    scan = pl.scan_csv(path, skip_lines=len(leading), separator=separator, infer_schema_length=HEAD)
    return _scanned(path, scan, "\n".join(line[1:] for line in leading))


def _scanned(path: Path, scan: pl.LazyFrame, metadata: str) -> Recording:
    """The head checked as a session, the rest as numbers."""
    try:
        first = scan.head(HEAD).collect()
    except UNREADABLE as error:
        raise refusal(str(path), f"cannot be read as a table: {error}") from error
    document = with_metadata(metadata, parquet.columns_of(first, str(path)), str(path))
    head = read_session(document, name=str(path))
    names = [sensor.name for sensor in head.sensors]
    return Recording(head, _chunks(path, scan.select(pl.col(names).cast(pl.Float64))))


def _chunks(path: Path, scan: pl.LazyFrame) -> Iterator[Chunk]:
    try:
        for frame in scan.collect_batches(chunk_size=CHUNK, maintain_order=True, lazy=True):
            yield frame.to_numpy()
    except UNREADABLE as error:
        raise refusal(str(path), f"cannot be read to its end: {error}", "table") from error
