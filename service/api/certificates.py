"""What is handed on of a session: its certificate, for people, and its correction, for firmware."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response

from service.admission import PersonOf
from service.api.exports import as_file
from service.api.schemas.corrections import CorrectionDocument
from service.api.schemas.fields import SessionId, Text
from service.api.schemas.papers import IssueList, IssueSchema
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading, SettingsOf, StorageOf
from service.flows.diagnose import diagnose
from service.flows.issue_certificate import issue_certificate
from service.records.paper import NOT_STATED
from service.reports.certificate import certificate_pdf
from service.reports.certificate.content import statement_of
from service.reports.dcc import certificate_dcc
from service.views.certificate import certified_session, laboratory_of
from service.views.correction import correction_document

router = APIRouter(prefix="/sessions", tags=["handing on"])
PDF, XML = "application/pdf", "application/xml"
"""Media types of the two forms."""
BYTES = {"schema": {"type": "string", "format": "binary"}}
"""How OpenAPI describes a file."""


@router.get(
    "/{id}/certificate",
    responses={200: {"content": {PDF: BYTES, XML: {"schema": {"type": "string"}}}}, **errors(404, 409, 422, 507)},
    response_class=Response,
)
def read_certificate(
    id: SessionId,
    storage: StorageOf,
    settings: SettingsOf,
    now: Now,
    person: PersonOf,
    *,
    format: Annotated[
        Literal["pdf", "dcc"], Query(description="For people, or as a Digital Calibration Certificate for programs.")
    ] = "pdf",
    by: Annotated[Text, Query(description="Who issues it; kept with its number.")] = "",
) -> Response:
    """The session's certificate, for people to sign or as XML.

    The first request issues it under a number of its own. Asked for again, the same record gives the same number and
    the same bytes; when what it states has changed, it has a new number and names the one it replaces.
    A session that is not accepted has none.
    """
    found = certified_session(storage, diagnose(storage, id, now), laboratory_of(settings))
    issue = issue_certificate(storage, statement_of(found), now, who=person.signs(by.strip()) or NOT_STATED)
    name = f"{found.report.session.unit}-{issue.number}-certificate"
    if format == "dcc":
        return as_file(certificate_dcc(found, issue), XML, f"{name}.xml")
    return as_file(certificate_pdf(found, issue), PDF, f"{name}.pdf")


@router.get("/{id}/certificates", responses=errors(404, 422))
def list_certificates(id: SessionId, store: Reading) -> IssueList:
    """The numbers under which the session's certificate was issued, the first one first; the last one holds."""
    store.sessions.get(id)
    return IssueList(certificates=[IssueSchema.model_validate(issue) for issue in store.certificates.of_session(id)])


@router.get("/{id}/correction", responses=errors(404, 422))
def read_correction(id: SessionId, storage: StorageOf) -> CorrectionDocument:
    """The correction for firmware: formula, numbers of every sensor, matrix and a worked example, imu-correction/1."""
    return CorrectionDocument.model_validate(correction_document(storage, id))
