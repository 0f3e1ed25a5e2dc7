"""Sessions: upload one, read them back."""

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from service.api.received import REQUEST_BODY, Received
from service.api.schemas.events import NewStage
from service.api.schemas.fields import Limit, Page, Revision, SessionId, Text, next_page
from service.api.schemas.problem import errors
from service.api.schemas.sessions import (
    CalibrationDocument,
    CommonMotionSchema,
    DecisionSchema,
    ReceiptSchema,
    SessionPage,
    SessionReportSchema,
    SessionSchema,
)
from service.dependencies import DiagnoserOf, MetricsOf, Now, Reading, SettingsOf, StorageOf
from service.flows.receive import upload
from service.flows.set_stage import set_stage
from service.views.session_decisions import session_decisions
from service.views.session_list import session_list

router = APIRouter(prefix="/sessions", tags=["sessions"])
ANY_BYTES = {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}


@router.post(
    "",
    status_code=201,
    responses={200: {"model": ReceiptSchema, "description": "Stored before."}, **errors(400, 413, 422, 507)},
    openapi_extra=REQUEST_BODY,
)
def upload_session(
    request: Request,
    response: Response,
    received: Received,
    storage: StorageOf,
    settings: SettingsOf,
    now: Now,
    diagnoser: DiagnoserOf,
    metrics: MetricsOf,
) -> ReceiptSchema:
    """Upload a session file: it is checked, calibrated, judged, stored, diagnosed. The same bytes are stored once."""
    receipt = upload(storage, received.content, received.filename, now, coverage_factor=settings.coverage_factor)
    diagnoser.after_upload(receipt.id)
    metrics.count_upload(receipt)
    url = str(request.url_for("read_session", id=receipt.id))
    response.status_code = 201 if receipt.created else 200
    response.headers["Location"] = url
    return ReceiptSchema(**vars(receipt), url=url)


@router.get("", responses=errors(422))
def list_sessions(
    store: Reading,
    unit: Annotated[Text | None, Query(description="Only sessions of this serial number.")] = None,
    page: Page = 1,
    limit: Limit = 100,
) -> SessionPage:
    """Sessions, newest measurement first."""
    found = session_list(store, unit=unit, page=page, limit=limit)
    listed = [SessionSchema.model_validate(session) for session in found]
    return SessionPage(sessions=listed, page=page, limit=limit, next_page=next_page(page, limit, len(listed)))


@router.get("/{id}", responses=errors(404, 422))
def read_session(id: SessionId, store: Reading) -> SessionReportSchema:
    """One session with the decision on every parameter."""
    session, decisions, motions = session_decisions(store, id)
    judged = [DecisionSchema.model_validate(decision) for decision in decisions]
    together = [CommonMotionSchema.model_validate(motion) for motion in motions]
    return SessionReportSchema(**vars(session), decisions=judged, common_motion=together)


@router.get("/{id}/calibration", responses=errors(404, 422), response_model=CalibrationDocument)
def read_calibration(id: SessionId, store: Reading, revision: Revision = None) -> Response:
    """The calibration in force, imu-calibration/1, as it was computed, or the one of a model revision."""
    return Response(store.calibrations.json(id, revision), media_type="application/json")


@router.put("/{id}/stage", responses=errors(400, 404, 422))
def mark_session(id: SessionId, new: NewStage, storage: StorageOf, now: Now) -> SessionSchema:
    """Say whether the session shows the unit as found or as left; the file's own word gives way to this."""
    return SessionSchema.model_validate(set_stage(storage, id, new.stage, new.by, now))


@router.get("/{id}/file", responses={200: {"content": ANY_BYTES}, **errors(404, 422)}, response_class=Response)
def read_file(id: SessionId, store: Reading, storage: StorageOf) -> Response:
    """The uploaded bytes, unchanged."""
    session = store.sessions.get(id)
    return Response(
        storage.files.read(session.sha256),
        media_type="application/octet-stream",
        headers={"Content-Disposition": f'attachment; filename="{id}"', "X-Content-Type-Options": "nosniff"},
    )
