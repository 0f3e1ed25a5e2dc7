"""The causes that engineers accepted, and the model that they add up to."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any


class Scope(StrEnum):
    """Whose model an accepted cause becomes part of."""

    UNIT = "unit"
    UNIT_TYPE = "unit type"
    STAND = "stand"


@dataclass(frozen=True)
class NewModel:
    """A cause that an engineer accepts."""

    cause: str
    scope: Scope
    by: str
    note: str


@dataclass(frozen=True)
class ModelRevision:
    """One accepted cause. Revisions are numbered through, so that a number says which model a result rests on."""

    id: int
    scope: Scope
    subject: str
    """Serial number of the unit, or name of the unit type or of the stand."""
    cause: str
    sensors: tuple[str, ...]
    session: str
    evidence: dict[str, Any]
    """Of the finding: p_value, strength, amplitude, sigma, units, and the gain."""
    accepted_by: str
    note: str
    accepted_at: datetime
    withdraws: int | None = None
    """The revision that this one withdraws; None for an accepted cause."""


@dataclass(frozen=True)
class Model:
    """The causes beyond the baseline that a session's calibration takes into account."""

    revision: int
    """The latest revision that concerns the session; 0 for the baseline alone."""
    causes: tuple[tuple[str, tuple[str, ...]], ...]
    """Identifier and sensors of each."""
