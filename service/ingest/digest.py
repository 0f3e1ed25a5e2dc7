"""Step: a session → a digest of its content, the same for JSON, CSV and every other format of it.

Taken over the session as it was checked, not over the bytes: numbers to ten digits, of which a spreadsheet keeps
fifteen; times in UTC.
"""

import hashlib
from dataclasses import fields, is_dataclass
from datetime import UTC, datetime

import numpy as np

from estimator.session import CalibrationSession

DIGITS = 32
"""Bits of a number that count: far below the noise of any reading, and far above what a format rounds off."""


def content_digest(session: CalibrationSession) -> str:
    """SHA-256 of everything that a session says."""
    digest = hashlib.sha256()
    for part in _parts("", session):
        digest.update(part)
    return digest.hexdigest()


def _parts(name: str, value: object) -> list[bytes]:
    """Every value with its name, in a fixed order; what is not stated is left out."""
    if value is None:
        return []
    if is_dataclass(value):
        return [part for f in fields(value) for part in _parts(f"{name}.{f.name}", getattr(value, f.name))]
    if isinstance(value, tuple):
        return [part for i, item in enumerate(value) for part in _parts(f"{name}[{i}]", item)]
    return [f"{name}=".encode(), _bytes(name, value), b"\n"]


def _bytes(name: str, value: object) -> bytes:
    if name == ".started_at":
        return _in_utc(str(value)).encode()
    if isinstance(value, str):
        return value.strip().encode()
    array = np.asarray(value, dtype=float)
    fraction, exponent = np.frexp(np.where(np.isfinite(array), array, 0.0))
    kept = np.rint(np.ldexp(fraction, DIGITS)) / 2.0**DIGITS
    rounded = np.where(np.isfinite(array), np.ldexp(kept, exponent) + 0.0, np.nan)
    return f"{array.shape}".encode() + rounded.astype("<f8").tobytes()


def _in_utc(stated: str) -> str:
    at = datetime.fromisoformat(stated)
    return (at if at.tzinfo else at.replace(tzinfo=UTC)).astimezone(UTC).isoformat()
