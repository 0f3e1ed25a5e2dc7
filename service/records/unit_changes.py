"""Notes, files, lot and customer of a unit are recorded and withdrawn; nothing is erased.

An attached file that is taken back stays on record and is given out no more.
"""

from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
from service.errors import ConflictError, NotFoundError, RefusedError
from service.fleet.changes import ask_for_summaries
from service.fleet.condition import UnitSummary
from service.fleet.store import Fleet
from service.ingest.checked import plain_filename
from service.kit.arriving_files import Content
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.units.records import Attachment, Customer, NewAttachment, Note, Withdrawal
from service.units.remarks_store import Attachments, Notes
from service.units.store import Units


def add_note(storage: Storage, serial: str, text: str, *, at: datetime, who: str, now: datetime) -> Note:
    """Keeps a note on a unit at a date."""
    with storage.database.writing() as store:
        id = Notes(store).add(Units(store).key(serial), at, text, who, now)
        Audit(store).write(now, who, "note", serial, {"note": id, "at": at.isoformat(), "text": text})
        return Notes(store).get(id)


def comment_on(storage: Storage, session: str, text: str, *, who: str, now: datetime) -> Note:
    """Keeps a note on a session; it is one of its unit's notes as well, at the date of the session."""
    with storage.database.writing() as store:
        about = Sessions(store).get(session)
        id = Notes(store).add(Units(store).key(about.unit), about.started_at, text, who, now, session=about.id)
        Audit(store).write(now, who, "note", about.unit, {"note": id, "session": about.id, "text": text})
        return Notes(store).get(id)


@dataclass(frozen=True)
class Attaching:
    """A file, its unit or session, and a description."""

    filename: str
    content: Content
    unit: str = ""
    session: str = ""
    """One of the two; a session's file is its unit's as well."""
    text: str = ""


def attach_file(storage: Storage, given: Attaching, who: str, now: datetime) -> Attachment:
    """Keeps an attached file; RefusedError where it is empty or attached to nothing. The same content attached to the
    same record again is there once."""
    faults = tuple(_faults(given))
    if faults:
        raise RefusedError("The file cannot be attached.", faults)
    with storage.database.reading() as store:
        _home(store, given)
    digest = storage.files.keep(given.content)
    with storage.database.writing() as store:
        unit, session = _home(store, given)
        key = Units(store).hold(unit)
        known = Attachments(store).of_session(session) if session else Attachments(store).of_unit(unit)
        for attachment in known:
            if (attachment.sha256, attachment.session, attachment.withdrawal) == (digest, session, None):
                return attachment
        name, size = plain_filename(given.filename), len(given.content)
        id = Attachments(store).add(key, NewAttachment(session, digest, name, size, given.text, who, now))
        details = {"attachment": id, "session": session, "sha256": digest, "filename": name}
        Audit(store).write(now, who, "attach", unit, details)
        return Attachments(store).get(id)


def withdraw_attachment(storage: Storage, id: int, who: str, why: str, now: datetime) -> Attachment:
    """Says that an attached file no longer holds, and why; ConflictError where that was said before."""
    with storage.database.writing() as store:
        attachment = Attachments(store).get(id)
        if not Attachments(store).withdraw(id, Withdrawal(now, who, why)):
            raise ConflictError("Attachment {id} was withdrawn before.", id=id)
        Audit(store).write(now, who, "withdraw attachment", attachment.unit, {"attachment": id, "why": why})
        return Attachments(store).get(id)


def given_out(store: Store, id: int) -> Attachment:
    """An attachment that may be downloaded; NotFoundError with the reason where it was withdrawn."""
    attachment = Attachments(store).get(id)
    if attachment.withdrawal is not None:
        parts = {"id": id, "who": attachment.withdrawal.who, "reason": attachment.withdrawal.why}
        raise NotFoundError("Attachment {id} was withdrawn by {who}: {reason}", **parts)
    return attachment


def _faults(given: Attaching) -> list[Problem]:
    found = []
    if not len(given.content):
        found.append(Problem("file", "is missing or empty"))
    if bool(given.unit) == bool(given.session):
        found.append(Problem("unit", "or `session` says what the file is attached to: one of the two"))
    return found


def _home(store: Store, given: Attaching) -> tuple[str, str | None]:
    if given.session:
        session = Sessions(store).get(given.session)
        return session.unit, session.id
    Units(store).key(given.unit)
    return given.unit, None


def set_lot(storage: Storage, serial: str, lot: str | None, now: datetime, *, who: str = "crew") -> UnitSummary:
    """Records the lot, or that none is known; the same one again changes nothing."""
    with storage.database.writing() as store:
        Units(store).hold(serial)
        was = Units(store).set_lot(serial, lot)
        if was != lot:
            ask_for_summaries(store, serial, now)
            Audit(store).write(now, who, "lot", serial, {"before": was, "lot": lot})
        return Fleet(store).get(serial)


def set_customer(storage: Storage, serial: str, new: Customer, now: datetime, *, who: str = "crew") -> Customer:
    """Records the customer, or with empty texts that none is known; the same one again changes nothing."""
    with storage.database.writing() as store:
        Units(store).hold(serial)
        before = Units(store).customer(serial)
        if before != new:
            Units(store).set_customer(serial, new)
            Audit(store).write(now, who, "customer", serial, {"before": vars(before), "customer": vars(new)})
    return new


def withdraw_note(storage: Storage, id: int, who: str, why: str, now: datetime) -> Note:
    """Says that a note no longer holds, and why; ConflictError where that was said before."""
    with storage.database.writing() as store:
        note = Notes(store).get(id)
        if not Notes(store).withdraw(id, who, why, now):
            raise ConflictError("Note {id} was withdrawn before.", id=id)
        Audit(store).write(now, who, "withdraw note", note.unit, {"note": id, "why": why})
        return Notes(store).get(id)
