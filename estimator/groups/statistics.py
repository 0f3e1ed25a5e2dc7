"""The statistics kept of a session for its groups: score and information of every candidate, of fixed size.

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

import numpy as np

from estimator.codec import MOMENT, Document, Form
from estimator.session import Array

FORMAT = "imu-session-statistics/2"
HARMONIC = "harmonic"
"""Nameless structure: a wave of β."""
STEPS = 32767
"""Steps of a correlation from 0 to 1, as two bytes hold them."""
LISTS = 64
"""Lists of candidates that are shared: one for every build of a unit, and for what its sessions recorded."""


@dataclass(frozen=True)
class Block:
    """One candidate: a cause (or nameless structure) at a place in a shape, with so many amplitudes."""

    cause: str
    sensor: str
    """Name of the sensor; empty for an effect on the applied vector."""
    kind: str
    """Kind of the sensor; empty where there is none."""
    shape: float | None
    """Time constant, s, or order of a harmonic; None where the cause has no shape."""
    width: int


def _packed(kind: str) -> Form:
    """Form of arrays: little-endian bytes of a number type, deflated, as text."""
    return Form(
        lambda values: base64.b64encode(zlib.compress(values.astype(kind).tobytes())).decode("ascii"),
        lambda text: np.frombuffer(zlib.decompress(base64.b64decode(text)), dtype=kind).astype(kind[1:]),
    )


@lru_cache(maxsize=LISTS)
def shared(blocks: tuple[Block, ...]) -> tuple[Block, ...]:
    """One list of candidates for all sessions that have the same, so that these are compared by identity."""
    return blocks


FLOATS = (
    "size", "score", "reach", "shrink", "energy", "freedom", "whole", "whole_freedom", "noise_factor",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class SessionStatistics(
    Document,
    format=FORMAT,
    order=(
        "unit", "unit_type", "stand", "started_at", "sensors", "blocks", "put_right", "size", "score", "correlation",
        "reach", "shrink", "energy", "freedom", "whole", "whole_freedom", "noise_factor",
    ),
    forms={
        "started_at": MOMENT,
        "blocks": Form(
            lambda blocks: [list(vars(block).values()) for block in blocks],
            lambda listed: shared(tuple(Block(*values) for values in listed)),
        ),
        "correlation": _packed("<i2"),
        **dict.fromkeys(FLOATS, _packed("<f8")),
    },
):  # fmt: skip
    """One session. D columns of all candidates, m sensors."""

    unit: str
    unit_type: str
    """Empty where the file states none."""
    stand: str
    """Empty where there is none."""
    started_at: str | None
    """Start in UTC; None where the file states none."""
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
    """(B,) factor with which a score enters the evidence: below 1 where the session itself gives the noise."""
    energy: Array
    """(m,) χ² of the residuals of each sensor, what the session itself shows plainly taken out."""
    freedom: Array
    """(m,) degrees of freedom of ``energy``."""
    whole: Array
    """(m,) χ² of the residuals of each sensor, with what the session itself shows plainly."""
    whole_freedom: Array
    """(m,) degrees of freedom of ``whole``."""
    noise_factor: Array
    """(m,) factor by which the stated standard errors were enlarged (or reduced), because the readings contradict
    them.
    """
    put_right: tuple[str, ...] = ()
    """Corrections of the record, made first, in words."""

    @property
    def subjects(self) -> tuple[str, str, str]:
        """The unit, its type and the stand."""
        return self.unit, self.unit_type, self.stand

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
        """The information at some ``rows`` and ``columns``, int, of one shape or such as broadcast to one."""
        low, high = np.minimum(rows, columns), np.maximum(rows, columns)
        return np.asarray(self.correlation[high * (high + 1) // 2 + low] / STEPS)


def quantised(information: Array, size: Array) -> Array:
    """(D·(D+1)/2,) int16 lower triangle of an information (D, D), SI, in units of ``size`` (D,)."""
    scale = np.where(size > 0, size, np.inf)
    relative = information / scale[:, None] / scale
    return np.round(relative[lower(len(size))] * STEPS).astype(np.int16)


@lru_cache(maxsize=2)
def lower(size: int) -> tuple[Array, Array]:
    """Rows and columns of the lower triangle of a matrix (size, size), dimensionless; kept for the next session."""
    return np.tril_indices(size)
