"""Flow: a remark is kept on a unit's history."""

from datetime import datetime

from service.records.event import Note
from service.storage import Storage


def add_note(storage: Storage, serial: str, text: str, *, at: datetime, who: str, now: datetime) -> Note:
    """Keeps a note on a unit at a date."""
    with storage.database.writing() as store:
        id = store.notes.add(store.units.key(serial), at, text, who, now)
        store.audit.write(now, who, "note", serial, {"note": id, "at": at.isoformat(), "text": text})
        return store.notes.get(id)
