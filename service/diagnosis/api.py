"""Diagnoses of sessions, and the acceptance of a named cause."""

import json

from fastapi import APIRouter, Response
from fastapi.responses import JSONResponse

from estimator.json_object import Json
from estimator.message import with_messages
from service.errors import NotFoundError
from service.models.api import DiagnosisDocument, ModelDocument, NewModelSchema, PendingDiagnosis, model_document
from service.models.records import NewModel
from service.records.dependencies import ReceptionOf
from service.records.models import accept_model
from service.records.recalibrate import recompute_beside
from service.web.dependencies import Now
from service.web.fields import SessionId
from service.web.problem_document import errors
from service.work.dependencies import ReaderOf

router = APIRouter(prefix="/sessions", tags=["diagnosis"])
RETRY_AFTER = "2"
"""Seconds: what the diagnosis of a larger session takes."""
PENDING: dict[int | str, Json] = {
    202: {"model": PendingDiagnosis, "description": "Still being made; ask again after Retry-After seconds."}
}
"""OpenAPI description of the answer while a diagnosis is being made."""


@router.get("/{id}/diagnosis", responses={**PENDING, **errors(404, 422)}, response_model=DiagnosisDocument)
def read_diagnosis(id: SessionId, reader: ReaderOf) -> Response | DiagnosisDocument:
    """The session's diagnosis, imu-diagnosis/1; waits some seconds for one being made."""
    found = reader.read(id)
    if found is None:
        return JSONResponse({"session": id, "status": "pending"}, 202, {"Retry-After": RETRY_AFTER})
    if found.document is None:
        raise NotFoundError(found.summary)
    made = {name: value for name, value in vars(found).items() if name in DiagnosisDocument.model_fields}
    return DiagnosisDocument(**with_messages(json.loads(found.document)), **made)


@router.post("/{id}/diagnosis/accept", status_code=201, responses=errors(400, 404, 409, 422))
def accept_cause(
    id: SessionId, new: NewModelSchema, reception: ReceptionOf, reader: ReaderOf, now: Now
) -> ModelDocument:
    """Accept a named cause: it is part of the model of the unit, unit type or stand. Flags that it explains are
    resolved, and the stored sessions are computed again: `GET /models/{id}` follows it."""
    accepted = accept_model(reception.storage, reader.made(id), NewModel(**new.model_dump()), now)
    recompute_beside(reception, now)
    return model_document(accepted)
