"""What a reading process can be asked for, by name. Only that process loads the libraries of the formats."""

from collections.abc import Callable

from estimator.reading import read_session
from service.ingest import hdf5, mat, parquet, xlsx
from service.ingest.formats import HDF5, MAT, PARQUET, XLSX
from service.ingest.limits import in_force

Reader = Callable[[bytes, str], dict[str, object]]

READERS: tuple[tuple[bytes, Reader], ...] = (
    (PARQUET, parquet.read_parquet),
    (XLSX, xlsx.read_xlsx),
    (HDF5, hdf5.read_hdf5),
    (MAT, mat.read_mat),
)
"""First bytes of a binary format, and what reads it; anything else is JSON or CSV, or refused as neither."""


def session(content: bytes, filename: str) -> object:
    """The checked session of a file of any format."""
    for magic, read in READERS:
        if content.startswith(magic):
            return read_session(read(content, filename), name=filename, most=in_force().extent)
    return read_session(content, name=filename, most=in_force().extent)


def mat_matrices(content: bytes, filename: str) -> object:
    """All variables of a MAT file, with up to three rows or columns."""
    return mat.variables(content, filename, most_rows=3)


JOBS: dict[str, Callable[[bytes, str], object]] = {"session": session, "mat-matrices": mat_matrices}
"""Name → what does it."""
