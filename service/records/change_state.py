"""Another line of a record's life, its state and the audit, within one transaction.

A questioned session is diagnosed by itself alone. Once it is accepted it is diagnosed beside its unit's earlier ones.
"""

from estimator.message import joined
from service.diagnosis.records import Diagnosed
from service.judging.records import Decided
from service.judging.store import Derivations
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import Derived, Deriving, derive_again
from service.records.flagging.settle import SERVICE
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Judged
from service.sessions.doubt import Remedies
from service.sessions.records import StoredSession
from service.sessions.states import RecordKind, RecordState, Step
from service.sessions.states_store import States
from service.sessions.store import NOT_JUDGED, Sessions
from service.storage.audit import Audit
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
        WorkQueue(store, WorkKind.DIAGNOSIS).ask_once(Derivations(store).forget_diagnosis(session.id), step.at)
    States(store).put_session(session.id, state, superseded_by)
    States(store).add(RecordKind.SESSION, session.id, state, step, superseded_by=superseded_by, remedies=remedies)
    details = {"unit": session.unit, "before": session.state.value, "why": step.why, "superseded_by": superseded_by}
    Audit(store).write(step.at, step.who, DONE[state], session.id, details)


def _was_questioned(store: Store, id: str) -> bool:
    return any(line.state is RecordState.QUESTIONED for line in States(store).of(RecordKind.SESSION, id))


OTHERWISE_WRITTEN = ("channels-swapped", "sign-reversed", "runs-swapped", "beta-reversed", "positions-swapped")
"""Causes that say of a file that it tells something else than what was done."""
QUESTIONED = "Questioned, not judged: "
"""Heads the reason."""
NOTHING_KNOWN = Remedies()
"""Nothing that would put it right."""


def question(store: Store, way: Deriving, session: StoredSession, why: str, remedies: Remedies = NOTHING_KNOWN) -> None:
    """Takes a stored session out of what counts, and says why before everything else, and what would put it right."""
    change(store, session, RecordState.QUESTIONED, Step(SERVICE, way.at, why), remedies=remedies)
    unjudged = Judged(Calibrations(store).get(session.id), (), QUESTIONED + why, is_reference=False)
    Derivations(store).put_judged((Decided(session.id, session.revision, unjudged, NOT_JUDGED, None),))


def question_diagnosed(store: Store, way: Deriving, id: str, found: Diagnosed) -> Derived | None:
    """Questions an accepted session whose diagnosis finds it written down otherwise than it was done.

    One that an engineer accepted stays so. What is left of what follows; None where nothing changed.
    """
    named = [finding for finding in found.findings if finding.cause in OTHERWISE_WRITTEN]
    session = Sessions(store).get(id)
    if not named or session.state is not RecordState.ACCEPTED or States(store).of(RecordKind.SESSION, id):
        return None
    question(store, way, session, joined(" ", (finding.sentence for finding in named)))
    return derive_again(store, way, session.unit, session.started_at, (id,))
