"""Flow: a session is marked as found or as left, or neither; what the file said and every change are in the audit."""

from datetime import datetime

from service.records.session import StoredSession
from service.storage import Storage


def set_stage(storage: Storage, id: str, stage: str | None, who: str, now: datetime) -> StoredSession:
    """Marks a session; the same mark again changes nothing."""
    with storage.database.writing() as store:
        session = store.sessions.get(id)
        if session.stage != stage:
            store.sessions.set_stage(id, stage)
            store.audit.write(now, who, "stage", id, {"unit": session.unit, "before": session.stage, "stage": stage})
        return store.sessions.get(id)
