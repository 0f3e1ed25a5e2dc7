"""What is kept of a session for its groups: score and information of every candidate, of fixed size.

Theory
------
With X the trace of a candidate (whitened with the session's noise and the stand's random errors, and projected off what
the session's calibration absorbs) and z the residual, the score U = X'z and the information F = X'X are sufficient for
its amplitude. The information among all candidates is kept, since rivals are weighed on the pool. It is held as
correlations in steps of 1/32767: that changes a correlation by less than separations of a hundredth part need, and
keeps a session's record in some hundred kilobytes.
"""

import base64
import zlib
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from estimator.moments import in_utc
from estimator.session import Array

FORMAT = "imu-session-statistics/2"
HARMONIC = "harmonic"
"""Nameless structure: a wave of β."""
STEPS = 32767
"""Of a correlation from 0 to 1: what two bytes hold."""
LISTS = 64
"""Lists of candidates that are shared: one for every build of a unit, and for what its sessions recorded."""


@dataclass(frozen=True)
class Block:
    """One candidate: a cause (or nameless structure) at a place in a shape, with so many amplitudes."""

    cause: str
    sensor: str
    """Its name; empty for what acts on the applied vector."""
    kind: str
    """Of the sensor; empty where there is none."""
    shape: float | None
    """Time constant, s, or order of a harmonic; None where the cause has no shape."""
    width: int

    def to_list(self) -> list[Any]:
        return [self.cause, self.sensor, self.kind, self.shape, self.width]


@dataclass(frozen=True, eq=False)
class SessionStatistics:
    """One session. D columns of all candidates, m sensors."""

    unit: str
    unit_type: str
    """Empty where the file states none."""
    stand: str
    """Empty where there is none."""
    started_at: str | None
    """In UTC; None where the file states none."""
    sensors: tuple[str, ...]
    blocks: tuple[Block, ...]
    size: Array
    """(D,) standard errors per unit amplitude: norm of every trace; 0 where the session does not see it."""
    score: Array
    """(D,) U in units of ``size``, standard errors."""
    correlation: Array
    """(D·(D+1)/2,) int16: lower triangle of F in units of ``size``, in `STEPS`."""
    reach: Array
    """(D,) largest change of a reading per unit amplitude, as part of the applied vector."""
    shrink: Array
    """(B,) by which a score enters the evidence: below 1 where the noise is estimated from the session itself."""
    energy: Array
    """(m,) χ² of the residuals of each sensor, what the session itself shows plainly taken out."""
    freedom: Array
    """(m,) its degrees of freedom."""
    whole: Array
    """(m,) χ² of the residuals of each sensor, with what the session itself shows plainly."""
    whole_freedom: Array
    """(m,) its degrees of freedom."""
    noise_factor: Array
    """(m,) by which the stated standard errors were enlarged (or reduced), because the readings contradict them."""
    put_right: tuple[str, ...] = ()
    """What of the record was put right first, in words."""

    @cached_property
    def starts(self) -> Array:
        """(B + 1,) int, dimensionless: first column of every block, and D."""
        return np.concatenate([[0], np.cumsum([b.width for b in self.blocks])]).astype(int)

    @property
    def information(self) -> Array:
        """(D, D) F in units of ``size``, dimensionless."""
        every = np.arange(len(self.size))
        return self.among(every[:, None], every)

    def among(self, rows: Array, columns: Array) -> Array:
        """The same at some ``rows`` and ``columns``, int, of one shape or such as broadcast to one."""
        low, high = np.minimum(rows, columns), np.maximum(rows, columns)
        return np.asarray(self.correlation[high * (high + 1) // 2 + low] / STEPS)

    def to_dict(self) -> dict[str, Any]:
        """``imu-session-statistics/2``; arrays are packed."""
        return {
            "format": FORMAT,
            "unit": self.unit,
            "unit_type": self.unit_type,
            "stand": self.stand,
            "started_at": self.started_at,
            "sensors": list(self.sensors),
            "blocks": [b.to_list() for b in self.blocks],
            "put_right": list(self.put_right),
            **{name: _packed(getattr(self, name), kind) for name, kind in PACKED.items()},
        }

    @classmethod
    def from_dict(cls, stored: dict[str, Any]) -> "SessionStatistics":
        """The record that `to_dict` wrote; ValueError of another format."""
        if stored.get("format") != FORMAT:
            raise ValueError(f"statistics of the format {stored.get('format')!r}, not {FORMAT}")
        return cls(
            unit=stored["unit"],
            unit_type=stored["unit_type"],
            stand=stored["stand"],
            started_at=in_utc(stored["started_at"]),
            sensors=tuple(stored["sensors"]),
            blocks=shared(tuple(Block(*b) for b in stored["blocks"])),
            put_right=tuple(stored["put_right"]),
            **{name: _unpacked(stored[name], kind) for name, kind in PACKED.items()},
        )


PACKED = {
    "size": "<f8",
    "score": "<f8",
    "correlation": "<i2",
    "reach": "<f8",
    "shrink": "<f8",
    "energy": "<f8",
    "freedom": "<f8",
    "whole": "<f8",
    "whole_freedom": "<f8",
    "noise_factor": "<f8",
}
"""Arrays and the number type in which each is kept, of little-endian bytes."""


def quantised(information: Array, size: Array) -> Array:
    """(D·(D+1)/2,) int16 lower triangle of an information (D, D), SI, in units of ``size`` (D,)."""
    scale = np.where(size > 0, size, np.inf)
    relative = information / scale[:, None] / scale
    return np.round(relative[lower(len(size))] * STEPS).astype(np.int16)


@lru_cache(maxsize=LISTS)
def shared(blocks: tuple[Block, ...]) -> tuple[Block, ...]:
    """One list of candidates for all sessions that have the same, so that these are told at a glance."""
    return blocks


@lru_cache(maxsize=2)
def lower(size: int) -> tuple[Array, Array]:
    """Rows and columns of the lower triangle of a matrix (size, size), dimensionless; kept for the next session."""
    return np.tril_indices(size)


def _packed(values: Array, kind: str) -> str:
    return base64.b64encode(zlib.compress(values.astype(kind).tobytes())).decode("ascii")


def _unpacked(text: str, kind: str) -> Array:
    values = np.frombuffer(zlib.decompress(base64.b64decode(text)), dtype=kind)
    return values.astype(values.dtype.newbyteorder("="))
