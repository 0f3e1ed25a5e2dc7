"""Flow: everything that a session's diagnosis page shows."""

from service.records import DiagnosisReport, StoredDiagnosis
from service.storage.store import Store


def diagnosis_report(store: Store, id: str, diagnosis: StoredDiagnosis | None) -> DiagnosisReport:
    """The session, its diagnosis, its calibration in force and the model revisions that concern it."""
    return DiagnosisReport(
        session=store.sessions.get(id),
        diagnosis=diagnosis,
        calibration=store.calibrations.get(id),
        revisions=store.models.of_session(id),
    )
