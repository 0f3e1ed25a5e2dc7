"""Step: a session that cannot be as its file says tells nothing of its unit until an engineer accepts it."""

from service.flows.change_state import change
from service.flows.derive_again import Derived, Deriving, derive_again
from service.flows.flagging.settle import SERVICE
from service.records.decision import Judged
from service.records.derivation import Decided
from service.records.diagnosis import Diagnosed
from service.records.doubt import Remedies
from service.records.session import StoredSession
from service.records.state import RecordKind, RecordState, Step
from service.storage.queries.sessions import NOT_JUDGED
from service.storage.store import Store

OTHERWISE_WRITTEN = ("channels-swapped", "sign-reversed", "runs-swapped", "beta-reversed", "positions-swapped")
"""Causes that say of a file that it tells something else than what was done."""
QUESTIONED = "Questioned, not judged: "
"""Heads the reason."""
NOTHING_KNOWN = Remedies()
"""Nothing that would put it right."""


def question(store: Store, way: Deriving, session: StoredSession, why: str, remedies: Remedies = NOTHING_KNOWN) -> None:
    """Takes a stored session out of what counts, and says why before everything else, and what would put it right."""
    change(store, session, RecordState.QUESTIONED, Step(SERVICE, way.at, why), remedies=remedies)
    unjudged = Judged(store.calibrations.get(session.id), (), QUESTIONED + why, is_reference=False)
    store.derivations.put_judged((Decided(session.id, session.revision, unjudged, NOT_JUDGED, None),))


def question_diagnosed(store: Store, way: Deriving, id: str, found: Diagnosed) -> Derived | None:
    """Questions an accepted session whose diagnosis finds it written down otherwise than it was done.

    One that an engineer accepted stays so. What is left of what follows; None where nothing changed.
    """
    named = [finding for finding in found.findings if finding.cause in OTHERWISE_WRITTEN]
    session = store.sessions.get(id)
    if not named or session.state is not RecordState.ACCEPTED or store.states.of(RecordKind.SESSION, id):
        return None
    question(store, way, session, " ".join(finding.sentence for finding in named))
    return derive_again(store, way, session.unit, session.started_at, (id,))
