"""Everything that a session's diagnosis page shows."""

from service.records.diagnosis import DiagnosisReport, StoredDiagnosis
from service.storage.store import Store


def diagnosis_report(store: Store, id: str, diagnosis: StoredDiagnosis | None) -> DiagnosisReport:
    """The session, its diagnosis, its calibration in force and the model revisions that concern it."""
    return DiagnosisReport(store.sessions.get(id), diagnosis, store.calibrations.get(id), store.models.of_session(id))
