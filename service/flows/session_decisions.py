"""Flow: one session and what was decided of its parameters."""

from service.records import Decision, StoredSession
from service.storage.store import Store


def session_decisions(store: Store, id: str) -> tuple[StoredSession, tuple[Decision, ...]]:
    """The session and its decisions, without its calibration."""
    return store.sessions.get(id), store.sessions.decisions(id)
