"""Stored diagnosis of a session, and its page's contents."""

from dataclasses import dataclass, field
from datetime import datetime

from estimator.codec import Document
from estimator.diagnosis import Diagnosis, Finding
from estimator.diagnosis.results import Gain, Limit, NoiseScale, Structure
from estimator.results import Calibration, Residuals
from service.models.records import ModelRevision
from service.sessions.decision import Verdict
from service.sessions.doubt import Reservation
from service.sessions.records import DiagnosisState, StoredSession
from service.sessions.words.noise import is_tenfold


def state_of(diagnosis: Diagnosis) -> DiagnosisState:
    """The state of a diagnosis: a named cause, a choice, structure without a name, or nothing; undecided where no
    reading is left over to judge by.
    """
    if diagnosis.findings:
        return DiagnosisState.UNDECIDED if diagnosis.findings[0].alternatives else DiagnosisState.NAMED
    if diagnosis.unexplained or is_tenfold(diagnosis.noise):
        return DiagnosisState.UNEXPLAINED
    return DiagnosisState.UNDECIDED if diagnosis.calibration.fit.is_exact else DiagnosisState.NOTHING


@dataclass(frozen=True)
class Diagnosed(Document, earlier=lambda old: {"structures": [], "noise": [], "notes": []} | old):
    """Contents of imu-diagnosis/1; a number that is null there, because it was not finite, is NaN."""

    findings: tuple[Finding, ...]
    structures: tuple[Structure, ...]
    gain: Gain
    limits: tuple[Limit, ...]
    noise: tuple[NoiseScale, ...]
    """Kinds of sensor whose stated standard errors the readings contradict."""
    notes: tuple[str, ...]
    calibration: Calibration = field(compare=False)
    """Calibration with the named causes in the model."""
    residuals_before: Residuals = field(compare=False)
    """Measured minus simulated under the baseline model."""


@dataclass(frozen=True)
class StoredDiagnosis:
    """Diagnosis of a session as it is stored."""

    session: str
    model_revision: int
    """Revision of the model in force when it was made."""
    state: DiagnosisState
    summary: str
    found: Diagnosed | None
    """Contents of the diagnosis; None where the session could not be diagnosed, or where no causes are looked for."""
    document: str | None
    """imu-diagnosis/1, JSON as it was written: what the API hands out; None where there was nothing to write."""
    verdict_after: Verdict | None
    """Verdict of the session with the named causes in the model; None where nothing was judged or named."""
    estimator_version: str
    created_at: datetime
    reservations: tuple[Reservation, ...] = ()
    """Reservations of the session's verdict."""
    gain_in_words: str = ""
    """Gain of the named causes, in one sentence; empty where none is named."""


@dataclass(frozen=True)
class DiagnosisReport:
    """Everything a session's diagnosis page shows."""

    session: StoredSession
    diagnosis: StoredDiagnosis | None
    """Diagnosis; None while it is being made."""
    calibration: Calibration
    """Calibration in force."""
    revisions: tuple[ModelRevision, ...]
    """Revisions that concern the session, oldest first."""
