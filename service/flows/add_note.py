"""Flow: a remark is kept on a unit's history, or on one of its sessions."""

from datetime import datetime

from service.records.event import Note
from service.storage import Storage


def add_note(storage: Storage, serial: str, text: str, *, at: datetime, who: str, now: datetime) -> Note:
    """Keeps a note on a unit at a date."""
    with storage.database.writing() as store:
        id = store.notes.add(store.units.key(serial), at, text, who, now)
        store.audit.write(now, who, "note", serial, {"note": id, "at": at.isoformat(), "text": text})
        return store.notes.get(id)


def comment_on(storage: Storage, session: str, text: str, *, who: str, now: datetime) -> Note:
    """Keeps a note on a session; it is one of its unit's notes as well, at the date of the session."""
    with storage.database.writing() as store:
        about = store.sessions.get(session)
        id = store.notes.add(store.units.key(about.unit), about.started_at, text, who, now, session=about.id)
        store.audit.write(now, who, "note", about.unit, {"note": id, "session": about.id, "text": text})
        return store.notes.get(id)
