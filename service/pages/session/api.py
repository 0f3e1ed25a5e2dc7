"""Sessions: upload one, read them back."""

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import FileResponse, JSONResponse
from pydantic import Field

from service.errors import NotFoundError
from service.ingest.layout.envelope import is_wrapped, unwrapped
from service.judging.records import said
from service.judging.reference import covered_at
from service.papers.certified import traceability_of
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.records.changes import set_mark, set_stage
from service.records.dependencies import ReceptionOf
from service.records.event_schemas import NewStage
from service.records.reception import Reception
from service.sessions.calibrations_store import Calibrations, SessionNoises
from service.sessions.decision import Verdict
from service.sessions.records import NoiseDocument, SessionOrder, SessionQuery
from service.sessions.schemas import (
    RECEIPT_EXAMPLE,
    CalibrationDocument,
    CommonMotionSchema,
    DecisionSchema,
    ReceiptAnswer,
    SaidSession,
    SessionPage,
    SessionReportAnswer,
    said_session,
)
from service.sessions.states import RecordState, Step
from service.sessions.store import Sessions
from service.uploads.api import LaterOf
from service.uploads.receive import deriving, receive, receive_mapped
from service.uploads.received import REQUEST_BODY, FileOf
from service.web.dependencies import Now, Reading
from service.web.fields import Body, Bound, Name, Reason, Revision, SessionId, Sought, WindowOf
from service.web.problem_document import errors
from service.work.api import JobAnswer

router = APIRouter(prefix="/sessions", tags=["sessions"])
NEWEST = SessionOrder.MEASURED
"""The order of a list that asks for none."""
BYTES = "application/octet-stream"
ANY_BYTES = {BYTES: {"schema": {"type": "string", "format": "binary"}}}
"""OpenAPI content of a file."""


@router.post(
    "",
    status_code=201,
    response_model=ReceiptAnswer,
    responses={
        200: {"model": ReceiptAnswer, "description": "Stored before."},
        201: {"content": {"application/json": {"example": RECEIPT_EXAMPLE}}},
        202: {"model": JobAnswer, "description": "Received: worked on beside the requests, as was asked for."},
        **errors(400, 404, 409, 413, 422, 507),
    },
    openapi_extra=REQUEST_BODY,
)
def upload_session(
    request: Request, response: Response, file: FileOf, reception: ReceptionOf, now: Now, later: LaterOf
) -> ReceiptAnswer | JSONResponse:
    """Upload a session file: it is checked, calibrated, judged, stored, diagnosed. The same content is stored once.

    A table of one's own layout comes with its `mapping`, as a part of the form.

    A corrected file names the session that it `supersedes`, by whom and why; unit and date may be others.

    With `Prefer: respond-async` a large file is acknowledged as soon as it is safe on disk, with 202 and its job.
    """
    if later.is_for(file, reception):
        return later.accepted(file, reception)
    if file.mapping is None:
        receipt = receive(reception, file, now)
    else:
        receipt = receive_mapped(reception, file, file.mapping, now)
    url = str(request.url_for("read_session", id=receipt.id))
    response.status_code = 201 if receipt.created else 200
    response.headers["Location"] = url
    return ReceiptAnswer(**said(receipt), url=url)


@router.get("", responses=errors(422))
def list_sessions(
    store: Reading,
    window: WindowOf,
    unit: Annotated[Sought | None, Query(description="Only sessions of this serial number.")] = None,
    *,
    unit_type: Annotated[Sought | None, Query(description="Only those of units of this type.")] = None,
    stand: Annotated[Sought | None, Query(description="Only those measured on this stand.")] = None,
    since: Annotated[Bound | None, Query(description="Only those measured then or later.")] = None,
    until: Annotated[Bound | None, Query(description="Only those measured before.")] = None,
    state: Annotated[RecordState | None, Query(description="Only those in this state.")] = None,
    verdict: Annotated[Verdict | None, Query(description="Only those with this verdict.")] = None,
    order: Annotated[SessionOrder, Query(description="By date of measurement newest first, by upload …")] = NEWEST,
    backwards: Annotated[bool, Query(description="The same order, last first.")] = False,
    after: Annotated[Sought | None, Query(description="Only those that come after this session.")] = None,
) -> SessionPage:
    """Sessions, newest measurement first unless another order is asked for."""
    wanted = SessionQuery(
        unit=unit, unit_type=unit_type, stand=stand, since=since, until=until, state=state, verdict=verdict,
        order=order, backwards=backwards, after=after, offset=window.offset, limit=window.limit,
    )  # fmt: skip
    found = Sessions(store).wanted(wanted)
    return SessionPage(sessions=list(map(said_session, found)), **window.place(len(found)))


@router.get("/{id}", responses=errors(404, 422))
def read_session(id: SessionId, store: Reading) -> SessionReportAnswer:
    """One session with the decision on every parameter."""
    session = Sessions(store).get(id)
    chain = traceability_of(store, session)
    return SessionReportAnswer(
        **said(session),
        decisions=tuple(map(DecisionSchema.model_validate, Sessions(store).decisions(id))),
        common_motion=tuple(map(CommonMotionSchema.model_validate, Sessions(store).motions(id))),
        stand_certificate_expired=chain.has_expired,
        traceability=chain,
        temperatures_covered=covered_at(store, session),
    )


@router.get("/{id}/calibration", responses=errors(404, 422), response_model=CalibrationDocument)
def read_calibration(id: SessionId, store: Reading, revision: Revision = None) -> Response:
    """The calibration in force, imu-calibration/1, as it was computed, or the one of a model revision."""
    return Response(Calibrations(store).json(id, revision), media_type="application/json")


@router.get("/{id}/noise", responses=errors(404, 422))
def read_noise(id: SessionId, store: Reading) -> NoiseDocument:
    """The noise of its sensors at rest, imu-noise/1: Allan terms and curves; only raw logs tell it."""
    Sessions(store).get(id)
    found = SessionNoises(store).get(id)
    if found is None:
        raise NotFoundError(
            "Session {id} has no noise results: it contains no rest periods, or is not evaluated yet.", id=id
        )
    return NoiseDocument.model_validate(found.to_dict())


@router.put("/{id}/stage", responses=errors(400, 404, 422))
def mark_session(id: SessionId, new: NewStage, storage: StorageOf, now: Now, person: PersonOf) -> SaidSession:
    """Say whether the session shows the unit as found or as left; this overrides the file."""
    return said_session(set_stage(storage, id, new.stage, person.signs(new.by), now))


class NewCheck(Body, json_schema_extra={"example": {"is_check": True, "by": "K. Ito", "why": "after transport"}}):
    """Whether a session is only a check."""

    is_check: bool = Field(description="A check is judged and kept, and moves no due date.")
    by: Name = Field(description="Who says so.")
    why: Reason = Field(description="Why.")


@router.put("/{id}/check", responses=errors(400, 404, 422))
def mark_check(id: SessionId, new: NewCheck, reception: ReceptionOf, now: Now, person: PersonOf) -> SaidSession:
    """Say that a session is only a check, or a calibration after all; its unit's dates are worked out again."""
    return _marked(reception, id, Step(person.signs(new.by), now, new.why), "check", is_so=new.is_check)


def _marked(reception: Reception, id: str, step: Step, word: str, *, is_so: bool) -> SaidSession:
    session = set_mark(reception.storage, deriving(reception, step.at), id, step, word, is_so=is_so)
    reception.ring()
    return said_session(session)


@router.get("/{id}/file", responses={200: {"content": ANY_BYTES}, **errors(404, 422, 500)}, response_class=Response)
def read_file(
    id: SessionId,
    store: Reading,
    storage: StorageOf,
    original: Annotated[bool, Query(description="Of a table with a mapping: the table alone.")] = False,
) -> Response:
    """The uploaded bytes, unchanged; of a table of one's own layout with the mapping, in one archive of two parts."""
    session = Sessions(store).get(id)
    content = storage.files.content(session.sha256)
    headers = {"Content-Disposition": f'attachment; filename="{id}"', "X-Content-Type-Options": "nosniff"}
    if original and is_wrapped(content):
        _, content = unwrapped(storage.files.read(session.sha256), session.filename)
    if isinstance(content, bytes):
        return Response(content, media_type=BYTES, headers=headers)
    return FileResponse(content, media_type=BYTES, headers=headers)
