"""Notes and files on the pages of units and sessions, and their forms."""

from collections.abc import Sequence
from dataclasses import dataclass
from urllib.parse import quote

from fastapi import APIRouter
from fastapi.responses import RedirectResponse

from service.kit.measures import size_in_words
from service.people.dependencies import SEE_OTHER, By, Key, Number, StorageOf, Why
from service.records.unit_changes import attach_file, comment_on, withdraw_attachment
from service.units.records import Attachment, Note
from service.uploads.received import SentOf
from service.web.dependencies import Now


@dataclass(frozen=True)
class AttachmentLine:
    """One attached file."""

    attachment: Attachment
    size: str

    @property
    def digest(self) -> str:
        """The head of its hash."""
        return self.attachment.sha256[:12]


@dataclass(frozen=True)
class Remarks:
    """All that was said of one record."""

    unit: str
    session: str
    """Id of the session; empty for the unit as a whole."""
    notes: tuple[Note, ...]
    files: tuple[AttachmentLine, ...]
    limit: str
    """Size limit of a file, in words."""


def remarks(unit: str, session: str, notes: Sequence[Note], files: Sequence[Attachment], most_bytes: int) -> Remarks:
    """The remarks on one record, oldest first."""
    lines = tuple(AttachmentLine(file, size_in_words(file.size)) for file in files)
    return Remarks(unit, session, tuple(notes), lines, size_in_words(most_bytes))


router = APIRouter(include_in_schema=False)


@router.post("/sessions/{id}/notes")
def comment(id: Key, text: Why, by: By, storage: StorageOf, now: Now) -> RedirectResponse:
    """Keeps a remark on a session."""
    comment_on(storage, id, text, who=by, now=now)
    return RedirectResponse(f"/sessions/{id}#remarks", SEE_OTHER)


@router.post("/attachments")
def attach(sent: SentOf, storage: StorageOf, now: Now) -> RedirectResponse:
    """Keeps a file."""
    return _back(attach_file(storage, sent.given, sent.who, now))


@router.post("/attachments/{id}/withdraw")
def withdraw(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """A file is given out no more."""
    return _back(withdraw_attachment(storage, id, by, why, now))


def _back(attachment: Attachment) -> RedirectResponse:
    home = f"/sessions/{attachment.session}" if attachment.session else f"/units/{quote(attachment.unit)}"
    return RedirectResponse(f"{home}#remarks", SEE_OTHER)
