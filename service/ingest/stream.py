"""A recording of any length, some rows at a time: Parquet and CSV are scanned by a process of their own, within the
limits of any file; other formats are read whole.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from estimator.session import CalibrationSession
from service.ingest import LONG, read_upload, start_of
from service.ingest.apart import read_parts
from service.ingest.formats import may_be_log

START = 4096
"""Bytes by which a file is told: blank lines may come first."""


@dataclass(frozen=True)
class Recording:
    """What a recording is, and its readings as they come."""

    head: CalibrationSession
    """The session of its first rows."""
    chunks: Iterator[NDArray[np.float64]]
    """(R, sensors) in the order measured; what is missing is NaN."""


def open_recording(path: Path) -> Recording:
    """The recording in a file; raises SessionError with every problem of its head."""
    if may_be_log(start_of(path, START)):
        parts = read_parts("recording", path, str(path))
        return Recording(next(parts), parts)
    session = session_in(path)
    return Recording(session, iter([session.readings]))


def session_in(path: Path) -> CalibrationSession:
    """The session in a file; nothing of a long one comes into this process before it is checked."""
    return read_upload(path if path.stat().st_size > LONG else path.read_bytes(), str(path))
