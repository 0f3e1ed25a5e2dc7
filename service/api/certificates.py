"""What is handed on of a session: its certificate, for people, and its correction, for firmware."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Query, Request, Response

from service.admission import PersonOf, attempt_of
from service.api.exports import as_file
from service.api.schemas.corrections import CorrectionDocument
from service.api.schemas.fields import TEXT, SessionId, Text
from service.api.schemas.papers import NewSignature
from service.api.schemas.problem import errors
from service.dependencies import DeskOf, Now, StorageOf
from service.flows.sign_certificate import Signing
from service.records.paper import NOT_STATED
from service.records.signature import Signature
from service.reports.desk import HandedOut, hand_out, hand_out_approved, sign
from service.reports.onboard import FORMS, System
from service.reports.onboard.stored import given_of
from service.reports.signatures import Papers, papers_of
from service.views.correction import correction_document

router = APIRouter(prefix="/sessions", tags=["handing on"])
PDF, XML = "application/pdf", "application/xml"
"""Media types of the two forms."""
BYTES = {"schema": {"type": "string", "format": "binary"}}
"""How OpenAPI describes a file."""
PLAIN = "text/plain; charset=utf-8"
TEXT_FILE: dict[int | str, dict[str, Any]] = {200: {"content": {"text/plain": {"schema": {"type": "string"}}}}}
FILES: dict[int | str, dict[str, Any]] = {200: {"content": {PDF: BYTES, XML: {"schema": {"type": "string"}}}}}
Format = Annotated[
    Literal["pdf", "dcc"], Query(description="For people, or as a Digital Calibration Certificate for programs.")
]
CertificateNumber = Annotated[
    str,
    Path(pattern=TEXT, max_length=60, description="Number of the certificate.", examples=["3f9a0c5be1d24786aa10-0-1"]),
]


@router.get(
    "/{id}/certificate",
    responses={**FILES, **errors(404, 409, 422, 507)},
    response_class=Response,
)
def read_certificate(
    id: SessionId,
    desk: DeskOf,
    now: Now,
    person: PersonOf,
    *,
    format: Format = "pdf",
    by: Annotated[Text, Query(description="Who issues it; kept with its number.")] = "",
) -> Response:
    """The session's certificate, for people to sign or as XML.

    The first request issues it under a number of its own. Asked for again, the same record gives the same number and
    the same bytes; when what it states has changed, it has a new number and names the one it replaces.
    A session that is not accepted has none.
    """
    paper = hand_out(desk, id, format, now, who=person.signs(by.strip()) or NOT_STATED)
    return _file(paper, format)


@router.get("/{id}/certificates", responses=errors(404, 422))
def list_certificates(id: SessionId, desk: DeskOf) -> Papers:
    """The numbers under which the session's certificate was issued, the first one first, with who signed them.

    The last one holds. What it rests on is worked out again and compared, and `concerns` says what has changed.
    """
    return papers_of(desk, id)


@router.get("/{id}/certificates/{number}", responses={**FILES, **errors(404, 422)}, response_class=Response)
def read_approved_certificate(
    id: SessionId, number: CertificateNumber, desk: DeskOf, format: Format = "pdf"
) -> Response:
    """An approved certificate as it was approved, byte by byte, whatever has changed since."""
    return _file(hand_out_approved(desk, id, number, format), format)


@router.post("/{id}/certificate/signatures", status_code=201, responses=errors(400, 401, 403, 404, 409, 422, 429, 507))
def sign_certificate(
    id: SessionId, new: NewSignature, desk: DeskOf, person: PersonOf, now: Now, request: Request
) -> Signature:
    """Sign the session's certificate: that you reviewed it, or that it is approved.

    Asks for the password of your account again. A certificate is reviewed first and approved by somebody else; both
    need the role engineer. An approved certificate is kept as it is, with the laboratory's electronic seal if it has
    one, and the same bytes are handed out from then on.
    """
    signing = Signing(id, new.number, new.meaning, person.login, new.password)
    signature = sign(desk, signing, attempt_of(request, person.login), now)
    return signature


def _file(paper: HandedOut, format: str) -> Response:
    media, ending = (XML, "xml") if format == "dcc" else (PDF, "pdf")
    return as_file(paper.content, media, f"{paper.name}.{ending}")


@router.get("/{id}/correction", responses=errors(404, 422))
def read_correction(id: SessionId, storage: StorageOf) -> CorrectionDocument:
    """The correction for firmware: formula, numbers of every sensor, matrix and a worked example, imu-correction/1."""
    return CorrectionDocument.model_validate(correction_document(storage, id))


@router.get("/{id}/export", responses={**TEXT_FILE, **errors(404, 409, 422)}, response_class=Response)
def read_export(
    id: SessionId,
    storage: StorageOf,
    system: Annotated[System, Query(description="PX4, ArduPilot, Kalibr or ROS 2.", examples=["px4"])],
) -> Response:
    """The correction as another system's parameters, with what that system cannot hold."""
    given, form = given_of(storage, id), FORMS[system]
    name = f"{given.unit}-{given.session[:8]}-{system}.{form.ending}"
    return as_file(form.written(given).encode(), PLAIN, name)
