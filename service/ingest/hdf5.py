"""HDF5: group `readings` with one dataset a column; the metadata as JSON in the root's text attribute `imu-session`."""

from pathlib import Path

from service.ingest.apart import read_apart
from service.ingest.metadata import KEY, with_metadata

MAGIC = b"\x89HDF\r\n\x1a\n"
"""First bytes (HDF5 file format, III.A)."""
CHILD = Path(__file__).with_name("hdf5_child.py")
"""Run by its path, so that it imports nothing of the service."""
MOST_CELLS = 5_000_000
"""Fewer than of other formats: they pass through a pipe as JSON."""


def read_hdf5(content: bytes, filename: str) -> dict[str, object]:
    """The document that an HDF5 file holds."""
    answer, _ = read_apart(CHILD, content, filename, KEY, str(MOST_CELLS))
    return with_metadata(answer["metadata"], answer["columns"], filename)
