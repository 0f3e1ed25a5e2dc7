"""Notes and files of units and sessions, over HTTP."""

from fastapi import APIRouter, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel, Field

from estimator.json_object import Json
from service.flags.api import Handling
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.records.event_schemas import NoteList
from service.records.unit_changes import attach_file, comment_on, given_out, withdraw_attachment, withdraw_note
from service.sessions.store import Sessions
from service.units.records import Attachment, Note
from service.units.remarks_store import Attachments, Notes
from service.units.store import Units
from service.uploads.received import SentOf
from service.web.dependencies import Now, Reading
from service.web.fields import Body, Name, Number, Reason, Serial, SessionId
from service.web.files import disposition
from service.web.problem_document import errors

router = APIRouter(prefix="/notes", tags=["units"])


@router.post("/{id}/withdraw", responses=errors(400, 404, 409, 422))
def withdraw(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> Note:
    """Say that a note no longer holds, and why. It stays on record."""
    return withdraw_note(storage, id, person.signs(handling.by), handling.why, now)


class AttachmentList(BaseModel):
    """Attached files, oldest first."""

    attachments: tuple[Attachment, ...] = Field(description="The files, withdrawn ones too.")


class NewComment(Body, json_schema_extra={"example": {"text": "the room was warm", "by": "K. Ito"}}):
    """A remark on a session."""

    text: Reason = Field(description="What is worth knowing.")
    by: Name = Field(description="Who says it.")


attachments_router = APIRouter()
BYTES = "application/octet-stream"
"""Media type of attached files: no browser shows unverified content."""
ANY_BYTES = {BYTES: {"schema": {"type": "string", "format": "binary"}}}
BODY: Json = {
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


@attachments_router.post(
    "/attachments", status_code=201, responses=errors(400, 404, 413, 422, 507), openapi_extra=BODY, tags=["units"]
)
def attach(sent: SentOf, storage: StorageOf, now: Now) -> Attachment:
    """Attach a file to a unit or to a session. The same content attached there again is there once."""
    return attach_file(storage, sent.given, sent.who, now)


@attachments_router.get("/attachments/{id}/file", responses={200: {"content": ANY_BYTES}, **errors(404, 422, 500)},
            response_class=Response, tags=["units"])  # fmt: skip
def download(id: Number, store: Reading, storage: StorageOf) -> Response:
    """The attached bytes, unchanged, always as a file to save; not of one that was withdrawn."""
    found = given_out(store, id)
    headers = {"Content-Disposition": disposition(found.filename), "X-Content-Type-Options": "nosniff"}
    content = storage.files.content(found.sha256)
    if isinstance(content, bytes):
        return Response(content, media_type=BYTES, headers=headers)
    return FileResponse(content, media_type=BYTES, headers=headers)


@attachments_router.post("/attachments/{id}/withdraw", responses=errors(400, 404, 409, 422), tags=["units"])
def withdraw_file(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> Attachment:
    """Say that an attached file no longer holds, and why. It stays on record and is given out no more."""
    gone = withdraw_attachment(storage, id, person.signs(handling.by), handling.why, now)
    return gone


@attachments_router.get("/units/{serial:path}/attachments", responses=errors(404, 422), tags=["units"])
def list_of_unit(serial: Serial, store: Reading) -> AttachmentList:
    """Files attached to the unit and to its sessions, withdrawn ones too, oldest first."""
    Units(store).key(serial)
    found = Attachments(store).of_unit(serial)
    return AttachmentList(attachments=found)


@attachments_router.get("/sessions/{id}/attachments", responses=errors(404, 422), tags=["sessions"])
def list_of_session(id: SessionId, store: Reading) -> AttachmentList:
    """Files attached to the session, withdrawn ones too, oldest first."""
    found = Attachments(store).of_session(Sessions(store).get(id).id)
    return AttachmentList(attachments=found)


@attachments_router.get("/sessions/{id}/notes", responses=errors(404, 422), tags=["sessions"])
def read_comments(id: SessionId, store: Reading) -> NoteList:
    """Remarks on the session, withdrawn ones too, in the order in which they were written."""
    session = Sessions(store).get(id)
    found = Notes(store).of_session(session.id)
    return NoteList(unit=session.unit, notes=found)


@attachments_router.post("/sessions/{id}/notes", status_code=201, responses=errors(400, 404, 422), tags=["sessions"])
def write_comment(id: SessionId, new: NewComment, storage: StorageOf, now: Now, person: PersonOf) -> Note:
    """Keep a remark on the session. It can be withdrawn, never changed."""
    return comment_on(storage, id, new.text, who=person.signs(new.by), now=now)
