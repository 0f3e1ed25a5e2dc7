"""What the simulation gets wrong about a stored session."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any

from estimator.results import Calibration, Residuals
from service.records.decision import Verdict
from service.records.model import ModelRevision
from service.records.session import StoredSession


class DiagnosisState(StrEnum):
    """What a diagnosis came to; not applicable: no causes are looked for in sessions of its programme."""

    NOTHING = "nothing wrong"
    NAMED = "named"
    UNDECIDED = "cannot tell which"
    UNEXPLAINED = "unexplained"
    FAILED = "failed"
    NOT_APPLICABLE = "not applicable"

    @property
    def is_wrong(self) -> bool:
        """Whether something is wrong that people should hear of."""
        return self in (DiagnosisState.NAMED, DiagnosisState.UNDECIDED, DiagnosisState.UNEXPLAINED)


@dataclass(frozen=True)
class DiagnosisSummary:
    """A session's diagnosis in one line."""

    state: DiagnosisState
    summary: str


@dataclass(frozen=True)
class StoredDiagnosis:
    """What the simulation gets wrong about a session."""

    session: str
    model_revision: int
    """In force when it was made."""
    state: DiagnosisState
    summary: str
    document: dict[str, Any] | None
    """imu-diagnosis/1; None where the session could not be diagnosed."""
    verdict_after: Verdict | None
    """The verdict that the session would have with the named causes in the model."""
    estimator_version: str
    created_at: datetime


@dataclass(frozen=True)
class DiagnosisReport:
    """Everything a session's diagnosis page shows."""

    session: StoredSession
    diagnosis: StoredDiagnosis | None
    """None while it is being made."""
    calibration: Calibration
    """In force."""
    before: Residuals | None
    """Measured minus simulated under the baseline model; None without a diagnosis."""
    after: Calibration | None
    """With the named causes in the model."""
    revisions: tuple[ModelRevision, ...]
    """That concern the session, oldest first."""
