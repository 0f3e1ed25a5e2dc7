"""Step: another line of a session's life, its state and the audit, within one transaction.

A questioned session is diagnosed by itself alone. Once it is accepted it is diagnosed beside its unit's earlier ones.
"""

from service.records.doubt import Remedies
from service.records.session import StoredSession
from service.records.state import RecordKind, RecordState, Step
from service.records.work import WorkKind
from service.storage.store import Store

DONE = {
    RecordState.ACCEPTED: "accept session",
    RecordState.QUESTIONED: "question session",
    RecordState.WITHDRAWN: "withdraw session",
    RecordState.SUPERSEDED: "supersede session",
}
"""What the audit calls each."""


def change(
    store: Store,
    session: StoredSession,
    state: RecordState,
    step: Step,
    *,
    superseded_by: str | None = None,
    remedies: Remedies | None = None,
) -> None:
    """Writes down what becomes of a session, by whom and why; what follows from it is derived afterwards."""
    if state is RecordState.ACCEPTED and _was_questioned(store, session.id):
        store.work(WorkKind.DIAGNOSIS).ask_once(store.derivations.forget_diagnosis(session.id), step.at)
    store.states.put_session(session.id, state, superseded_by)
    store.states.add(RecordKind.SESSION, session.id, state, step, superseded_by=superseded_by, remedies=remedies)
    details = {"unit": session.unit, "before": session.state.value, "why": step.why, "superseded_by": superseded_by}
    store.audit.write(step.at, step.who, DONE[state], session.id, details)


def _was_questioned(store: Store, id: str) -> bool:
    return any(line.state is RecordState.QUESTIONED for line in store.states.of(RecordKind.SESSION, id))
