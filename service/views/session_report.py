"""Everything that is known of one session."""

from service.records.session import SessionReport
from service.records.state import RecordKind
from service.storage.store import Store


def session_report(store: Store, id: str) -> SessionReport:
    """The session, its calibration and its decisions."""
    return SessionReport(
        session=store.sessions.get(id),
        calibration=store.calibrations.get(id),
        decisions=store.sessions.decisions(id),
        motions=store.sessions.motions(id),
        states=store.states.of(RecordKind.SESSION, id),
    )
