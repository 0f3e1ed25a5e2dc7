"""Flow: sessions, newest measurement first."""

from service.records.session import StoredSession
from service.storage.store import Store


def session_list(
    store: Store, *, unit: str | None = None, page: int = 1, limit: int = 100
) -> tuple[StoredSession, ...]:
    """One page of the sessions of one unit, or of all."""
    return store.sessions.page(unit, (page - 1) * limit, limit)
