"""Uploads of every accepted format → one checked session. The content decides what a file is, never its name."""

from collections.abc import Callable
from pathlib import Path

from estimator.reading import read_session
from estimator.session import CalibrationSession
from service.ingest import hdf5, mat, parquet, xlsx

Reader = Callable[[bytes, str], dict[str, object]]

READERS: tuple[tuple[bytes, Reader], ...] = (
    (parquet.MAGIC, parquet.read_parquet),
    (xlsx.MAGIC, xlsx.read_xlsx),
    (hdf5.MAGIC, hdf5.read_hdf5),
    (mat.MAGIC, mat.read_mat),
)
"""First bytes of a binary format, and what reads it; anything else is JSON or CSV, or refused as neither."""


def read_upload(content: bytes, filename: str) -> CalibrationSession:
    """The session that the content holds; raises SessionError with every problem, named after the file."""
    for magic, read in READERS:
        if content.startswith(magic):
            return read_session(read(content, filename), name=filename)
    return read_session(content, name=filename)


def read_file(path: Path) -> CalibrationSession:
    """The same for a file on this machine, where the metadata of a CSV table may stand in a JSON file beside it."""
    with path.open("rb") as file:
        start = file.read(max(len(magic) for magic, _ in READERS))
    if any(start.startswith(magic) for magic, _ in READERS):
        return read_upload(path.read_bytes(), str(path))
    return read_session(path)
