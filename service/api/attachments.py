"""Files that people attach to units and sessions, and remarks on sessions."""

from typing import Any

from fastapi import APIRouter, Response
from fastapi.responses import FileResponse

from service.admission import PersonOf
from service.api.exports import disposition
from service.api.schemas.attachments import AttachmentList, NewComment
from service.api.schemas.events import NoteList
from service.api.schemas.fields import Number, Serial, SessionId
from service.api.schemas.flags import Handling
from service.api.schemas.problem import errors
from service.arriving import SentOf
from service.dependencies import Now, Reading, StorageOf
from service.flows.add_note import comment_on
from service.flows.attach_file import attach_file, given_out, withdraw_attachment
from service.records.event import Attachment, Note

router = APIRouter()
BYTES = "application/octet-stream"
"""What nobody vouches for is shown by no browser."""
ANY_BYTES = {BYTES: {"schema": {"type": "string", "format": "binary"}}}
BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "description": "A form with the `file`, and with the `unit` or the `session` that it is attached to.",
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {"file": {"type": "string", "format": "binary", "description": "The file."}}
                    | {name: {"type": "string"} for name in ("unit", "session", "text", "by")},
                }
            }
        },
    }
}


@router.post(
    "/attachments", status_code=201, responses=errors(400, 404, 413, 422, 507), openapi_extra=BODY, tags=["units"]
)
def attach(sent: SentOf, storage: StorageOf, now: Now) -> Attachment:
    """Attach a file to a unit or to a session. The same content attached there again is there once."""
    return attach_file(storage, sent.given, sent.who, now)


@router.get("/attachments/{id}/file", responses={200: {"content": ANY_BYTES}, **errors(404, 422, 500)},
            response_class=Response, tags=["units"])  # fmt: skip
def download(id: Number, store: Reading, storage: StorageOf) -> Response:
    """The attached bytes, unchanged, always as a file to save; not of one that was withdrawn."""
    found = given_out(store, id)
    headers = {"Content-Disposition": disposition(found.filename), "X-Content-Type-Options": "nosniff"}
    content = storage.files.content(found.sha256)
    if isinstance(content, bytes):
        return Response(content, media_type=BYTES, headers=headers)
    return FileResponse(content, media_type=BYTES, headers=headers)


@router.post("/attachments/{id}/withdraw", responses=errors(400, 404, 409, 422), tags=["units"])
def withdraw(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> Attachment:
    """Say that an attached file no longer holds, and why. It stays on record and is given out no more."""
    gone = withdraw_attachment(storage, id, person.signs(handling.by), handling.why, now)
    return gone


@router.get("/units/{serial:path}/attachments", responses=errors(404, 422), tags=["units"])
def list_of_unit(serial: Serial, store: Reading) -> AttachmentList:
    """Files attached to the unit and to its sessions, withdrawn ones too, oldest first."""
    store.units.key(serial)
    found = store.attachments.of_unit(serial)
    return AttachmentList(attachments=found)


@router.get("/sessions/{id}/attachments", responses=errors(404, 422), tags=["sessions"])
def list_of_session(id: SessionId, store: Reading) -> AttachmentList:
    """Files attached to the session, withdrawn ones too, oldest first."""
    found = store.attachments.of_session(store.sessions.get(id).id)
    return AttachmentList(attachments=found)


@router.get("/sessions/{id}/notes", responses=errors(404, 422), tags=["sessions"])
def read_comments(id: SessionId, store: Reading) -> NoteList:
    """Remarks on the session, withdrawn ones too, in the order in which they were written."""
    session = store.sessions.get(id)
    found = store.notes.of_session(session.id)
    return NoteList(unit=session.unit, notes=found)


@router.post("/sessions/{id}/notes", status_code=201, responses=errors(400, 404, 422), tags=["sessions"])
def write_comment(id: SessionId, new: NewComment, storage: StorageOf, now: Now, person: PersonOf) -> Note:
    """Keep a remark on the session. It can be withdrawn, never changed."""
    return comment_on(storage, id, new.text, who=person.signs(new.by), now=now)
