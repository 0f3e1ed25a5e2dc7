"""The forms of remarks on sessions, and of files that are attached to units and sessions."""

from urllib.parse import quote

from fastapi import APIRouter
from fastapi.responses import RedirectResponse

from service.arriving import SentOf
from service.dependencies import Now, StorageOf
from service.flows.add_note import comment_on
from service.flows.attach_file import attach_file, withdraw_attachment
from service.pages.forms import SEE_OTHER, By, Key, Number, Why
from service.records.event import Attachment

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
