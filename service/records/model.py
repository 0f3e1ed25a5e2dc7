"""The causes that engineers accepted, and the model that they add up to."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from estimator.diagnosis.results import Gain


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
class Evidence:
    """The finding that a cause was accepted on, and what naming it was worth."""

    p_value: float
    strength: float
    amplitude: tuple[float, ...]
    """SI, with ``sigma`` and ``units``; empty where the cause was an equal alternative of the named one."""
    sigma: tuple[float, ...]
    units: tuple[str, ...]
    nonlinear: dict[str, float]
    alternatives: tuple[str, ...]
    sentence: str
    gain: Gain


@dataclass(frozen=True)
class ModelRevision:
    """One accepted cause. Revisions are numbered through, so that a number says which model a result rests on."""

    id: int
    """0 before it is stored."""
    scope: Scope
    subject: str
    """Serial number of the unit, or name of the unit type or of the stand."""
    cause: str
    sensors: tuple[str, ...]
    session: str
    evidence: Evidence | None
    """None of a revision that withdraws another."""
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
