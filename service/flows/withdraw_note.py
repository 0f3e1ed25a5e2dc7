"""Flow: a remark that no longer holds is withdrawn with a reason, never erased."""

from datetime import datetime

from service.errors import ConflictError
from service.records.event import Note
from service.storage import Storage


def withdraw_note(storage: Storage, id: int, who: str, why: str, now: datetime) -> Note:
    """Says that a note no longer holds, and why; ConflictError where that was said before."""
    with storage.database.writing() as store:
        note = store.notes.get(id)
        if not store.notes.withdraw(id, who, why, now):
            raise ConflictError(f"Note {id} was withdrawn before.")
        store.audit.write(now, who, "withdraw note", note.unit, {"note": id, "why": why})
        return store.notes.get(id)
