"""A recording of any length, some rows at a time: Parquet and CSV are scanned in a separate process, within the limits
of any file; other formats are read whole."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from estimator.session import CalibrationSession
from service.ingest import LONG, read_upload
from service.ingest.apart import read_parts
from service.ingest.formats import may_be_log, start_of

START = 4096
"""Bytes from which the format is recognised: blank lines may come first."""


@dataclass(frozen=True)
class Recording:
    """The metadata of a recording, and its readings as they arrive."""

    head: CalibrationSession
    """The session of its first rows."""
    chunks: Iterator[NDArray[np.float64]]
    """(R, sensors) in the order measured; a missing reading is NaN."""


def open_recording(path: Path) -> Recording:
    """The recording in a file; raises SessionError with every problem of its head."""
    if may_be_log(start_of(path, START)):
        parts = read_parts("recording", path, str(path))
        return Recording(next(parts), parts)
    session = session_in(path)
    return Recording(session, iter([session.readings]))


def session_in(path: Path) -> CalibrationSession:
    """The session in a file; a long one is checked before any of it comes into this process."""
    return read_upload(path if path.stat().st_size > LONG else path.read_bytes(), str(path))
