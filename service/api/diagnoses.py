"""Diagnoses: what the simulation gets wrong about a session, and the acceptance of a named cause."""

import json
from typing import Any

from fastapi import APIRouter, Response
from fastapi.responses import JSONResponse

from service.api.schemas.fields import SessionId
from service.api.schemas.models import (
    DiagnosisDocument,
    ModelDocument,
    NewModelSchema,
    PendingDiagnosis,
    model_document,
)
from service.api.schemas.problem import errors
from service.dependencies import Now, ReaderOf, StorageOf
from service.errors import NotFoundError
from service.flows.accept_model import accept_model
from service.records.model import NewModel

router = APIRouter(prefix="/sessions", tags=["diagnosis"])
RETRY_AFTER = "2"
"""Seconds: what the diagnosis of a larger session takes."""
PENDING: dict[int | str, dict[str, Any]] = {
    202: {"model": PendingDiagnosis, "description": "Still being made; ask again after Retry-After seconds."}
}
"""How OpenAPI describes the answer while a diagnosis is being made."""


@router.get("/{id}/diagnosis", responses={**PENDING, **errors(404, 422)}, response_model=DiagnosisDocument)
def read_diagnosis(id: SessionId, reader: ReaderOf) -> Response | DiagnosisDocument:
    """What the simulation gets wrong about the session, imu-diagnosis/1; waits some seconds for one being made."""
    found = reader.read(id)
    if found is None:
        return JSONResponse({"session": id, "status": "pending"}, 202, {"Retry-After": RETRY_AFTER})
    if found.document is None:
        raise NotFoundError(found.summary)
    made = {name: value for name, value in vars(found).items() if name in DiagnosisDocument.model_fields}
    return DiagnosisDocument(**json.loads(found.document), **made)


@router.post("/{id}/diagnosis/accept", status_code=201, responses=errors(400, 404, 409, 422))
def accept_cause(id: SessionId, new: NewModelSchema, storage: StorageOf, reader: ReaderOf, now: Now) -> ModelDocument:
    """Accept a named cause: from the next session on it is part of the model of the unit, unit type or stand."""
    accepted = accept_model(storage, reader.made(id), NewModel(**new.model_dump()), now)
    return model_document(accepted)
