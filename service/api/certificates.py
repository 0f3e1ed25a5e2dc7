"""What is handed on of a session: its certificate, for people, and its correction, for firmware."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response

from service.api.exports import as_file
from service.api.schemas.corrections import CorrectionDocument
from service.api.schemas.fields import SessionId
from service.api.schemas.problem import errors
from service.dependencies import Now, StorageOf
from service.flows.diagnose import diagnose
from service.reports.certificate import certificate_pdf
from service.reports.dcc import certificate_dcc
from service.views.certificate import certified_session
from service.views.correction import correction_document

router = APIRouter(prefix="/sessions", tags=["handing on"])
PDF, XML = "application/pdf", "application/xml"
"""Media types of the two forms."""
BYTES = {"schema": {"type": "string", "format": "binary"}}
"""How OpenAPI describes a file."""


@router.get(
    "/{id}/certificate",
    responses={200: {"content": {PDF: BYTES, XML: {"schema": {"type": "string"}}}}, **errors(404, 422, 507)},
    response_class=Response,
)
def read_certificate(
    id: SessionId,
    storage: StorageOf,
    now: Now,
    format: Annotated[
        Literal["pdf", "dcc"], Query(description="For people, or as a Digital Calibration Certificate for programs.")
    ] = "pdf",
) -> Response:
    """The session's certificate, for people to sign or as XML; the same record gives the same bytes."""
    found = certified_session(storage, diagnose(storage, id, now))
    name = f"{found.report.session.unit}-{id[:8]}-certificate"
    if format == "dcc":
        return as_file(certificate_dcc(found), XML, f"{name}.xml")
    return as_file(certificate_pdf(found), PDF, f"{name}.pdf")


@router.get("/{id}/correction", responses=errors(404, 422))
def read_correction(id: SessionId, storage: StorageOf) -> CorrectionDocument:
    """The correction for firmware: formula, numbers of every sensor, matrix and a worked example, imu-correction/1."""
    return CorrectionDocument.model_validate(correction_document(storage, id))
