"""Uploads of every accepted format → one checked session. The content decides what a file is, never its name."""

from collections.abc import Callable

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
