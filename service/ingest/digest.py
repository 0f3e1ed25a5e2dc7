"""Step: a session → a digest of its content, the same for JSON, CSV and every other format of it.

Taken over the session as it was checked, not over the bytes: numbers to ten digits, of which a spreadsheet keeps
fifteen; times in UTC.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import fields, is_dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.moments import moment
from estimator.session import CalibrationSession

DIGITS = 32
"""Bits of a number that count: far below the noise of any reading, and far above what a format rounds off."""

BLOCK = 100_000
"""Numbers rounded at a time: each takes about ten times its size meanwhile."""


def content_digest(session: CalibrationSession) -> str:
    """SHA-256 of everything stated in a session."""
    digest = hashlib.sha256()
    for part in _parts("", session):
        digest.update(part)
    return digest.hexdigest()


def readings_digest(session: CalibrationSession) -> str:
    """SHA-256 of the readings alone: the same under other names of unit and sensors, other dates and notes, and another
    order of sensors."""
    columns = (b"".join(_bytes("", column)) for column in session.readings.T)
    return hashlib.sha256(b"".join(sorted(hashlib.sha256(column).digest() for column in columns))).hexdigest()


def _parts(name: str, value: object) -> Iterator[bytes]:
    if value is None:
        return
    if is_dataclass(value):
        for f in fields(value):
            yield from _parts(f"{name}.{f.name}", getattr(value, f.name))
    elif isinstance(value, tuple):
        for i, item in enumerate(value):
            yield from _parts(f"{name}[{i}]", item)
    else:
        yield f"{name}=".encode()
        yield from _bytes(name, value)
        yield b"\n"


def _bytes(name: str, value: object) -> Iterator[bytes]:
    if name == ".started_at":
        yield moment(str(value)).isoformat().encode()
    elif isinstance(value, str):
        yield value.strip().encode()
    else:
        array = np.asarray(value)
        yield f"{array.shape}".encode()
        flat = array.reshape(-1)
        for start in range(0, len(flat), BLOCK):
            yield _rounded(flat[start : start + BLOCK].astype(float))


def _rounded(array: NDArray[np.float64]) -> bytes:
    fraction, exponent = np.frexp(np.where(np.isfinite(array), array, 0.0))
    kept = np.rint(np.ldexp(fraction, DIGITS)) / 2.0**DIGITS
    rounded = np.where(np.isfinite(array), np.ldexp(kept, exponent) + 0.0, np.nan)
    return rounded.astype("<f8").tobytes()
