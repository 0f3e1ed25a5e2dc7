"""Flow: a file is attached to a unit or a session: kept under its hash as uploads are, and never given out as anything
but a file to save. One that is taken back stays on record and is given out no more."""

from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
from service.errors import ConflictError, NotFoundError, RefusedError
from service.ingest.checked import plain_filename
from service.records.event import Attachment, NewAttachment, Withdrawal
from service.records.received import Content
from service.storage import Storage
from service.storage.store import Store


@dataclass(frozen=True)
class Attaching:
    """A file, what it is attached to, and what somebody says of it."""

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
        key = store.units.hold(unit)
        known = store.attachments.of_session(session) if session else store.attachments.of_unit(unit)
        for one in known:
            if (one.sha256, one.session, one.withdrawal) == (digest, session, None):
                return one
        name, size = plain_filename(given.filename), len(given.content)
        id = store.attachments.add(key, NewAttachment(session, digest, name, size, given.text, who, now))
        details = {"attachment": id, "session": session, "sha256": digest, "filename": name}
        store.audit.write(now, who, "attach", unit, details)
        return store.attachments.get(id)


def withdraw_attachment(storage: Storage, id: int, who: str, why: str, now: datetime) -> Attachment:
    """Says that an attached file no longer holds, and why; ConflictError where that was said before."""
    with storage.database.writing() as store:
        attachment = store.attachments.get(id)
        if not store.attachments.withdraw(id, Withdrawal(now, who, why)):
            raise ConflictError(f"Attachment {id} was withdrawn before.")
        store.audit.write(now, who, "withdraw attachment", attachment.unit, {"attachment": id, "why": why})
        return store.attachments.get(id)


def given_out(store: Store, id: int) -> Attachment:
    """An attachment that may be downloaded; NotFoundError with the reason where it was withdrawn."""
    attachment = store.attachments.get(id)
    if attachment.withdrawal is not None:
        raise NotFoundError(
            f"Attachment {id} was withdrawn by {attachment.withdrawal.who}: {attachment.withdrawal.why}"
        )
    return attachment


def _faults(given: Attaching) -> list[Problem]:
    found = []
    if not len(given.content):
        found.append(Problem("file", "is missing or empty"))
    if bool(given.unit) == bool(given.session):
        found.append(Problem("unit", "or `session` says what the file is attached to: one of the two"))
    return found


def _home(store: Store, given: Attaching) -> tuple[str, str | None]:
    """Unit and session; NotFoundError where there is none."""
    if given.session:
        session = store.sessions.get(given.session)
        return session.unit, session.id
    store.units.key(given.unit)
    return given.unit, None
