"""Everything that a session's diagnosis page shows."""

from service.records.diagnosis import DiagnosisReport, DiagnosisState, StoredDiagnosis
from service.storage.calibration_document import calibration_from_dict, residuals_from_dict
from service.storage.store import Store


def diagnosis_report(store: Store, id: str, diagnosis: StoredDiagnosis | None) -> DiagnosisReport:
    """The session, its diagnosis, its calibration in force and the model revisions that concern it."""
    made = diagnosis is not None and diagnosis.state is not DiagnosisState.NOT_APPLICABLE
    document = diagnosis.document if diagnosis is not None and made else None
    return DiagnosisReport(
        session=store.sessions.get(id),
        diagnosis=diagnosis,
        calibration=store.calibrations.get(id),
        before=None if document is None else residuals_from_dict(document["residuals_before"]),
        after=None if document is None else calibration_from_dict(document["calibration"]),
        revisions=store.models.of_session(id),
    )
