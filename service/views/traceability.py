"""What a stored session's numbers hang on."""

from service.records.paper import Traceability
from service.records.session import StoredSession
from service.storage.store import Store
from service.words.traceability import traceability


def traceability_of(store: Store, session: StoredSession) -> Traceability:
    """By the certificate of its stand at the day of measurement, UTC."""
    day = session.started_at.date()
    found = None if session.stand is None else store.stand_certificates.on(session.stand, day)
    return traceability(session.stand, found, day)
