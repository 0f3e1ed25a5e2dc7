"""Everything that is known of one session."""

from service.records.session_report import SessionReport
from service.records.state import RecordKind
from service.storage.store import Store


def session_report(store: Store, id: str) -> SessionReport:
    """The session, its calibration and its decisions."""
    session, diagnosis, failed, calibration = store.calibrations.with_session(id)
    decisions, motions = store.sessions.judged(id)
    states = store.states.of(RecordKind.SESSION, id)
    return SessionReport(session, calibration, decisions, motions, states, diagnosis, failed)
