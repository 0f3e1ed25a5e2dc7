"""Certificates, corrections and labels over HTTP."""

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Path, Query, Request, Response

from estimator.json_object import Json
from service.fleet.store import Fleet
from service.judging.usable_reading import usable_of
from service.papers.changes import Signing
from service.papers.correction import correction_document
from service.papers.dependencies import DeskOf
from service.papers.desk import (
    CertificateDocument,
    Papers,
    hand_out,
    hand_out_approved,
    hand_out_together,
    papers_of,
    sign,
)
from service.papers.label import Label, label_of, label_pdf, label_svg
from service.papers.records import NOT_STATED, Signature
from service.papers.schemas import CorrectionDocument, NewSignature
from service.papers.status import status_paper, status_pdf
from service.people.admission import PersonOf, attempt_of
from service.people.dependencies import PasswordTurn, StorageOf
from service.settings import Settings
from service.storage.queries import Store
from service.web.dependencies import LanguageOf, Now, Reading, SettingsOf
from service.web.fields import Serial, SessionId, Sought, Text
from service.web.files import as_file
from service.web.problem_document import errors

router = APIRouter(prefix="/sessions", tags=["handing on"])
PDF, XML = "application/pdf", "application/xml"
"""Media types of the two forms."""
BYTES = {"schema": {"type": "string", "format": "binary"}}
"""OpenAPI schema of a file."""
FILES: dict[int | str, Json] = {200: {"content": {PDF: BYTES, XML: {"schema": {"type": "string"}}}}}
Format = Annotated[
    Literal["pdf", "dcc"], Query(description="For people, or as a Digital Calibration Certificate for programs.")
]
CertificateNumber = Annotated[
    str,
    Path(max_length=60, description="Number of the certificate.", examples=["3f9a0c5be1d24786aa10-0-1"]),
]


@router.get("/{id}/certificate", responses={**FILES, **errors(404, 409, 422, 507)}, response_class=Response)
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

    The first request issues it under a number of its own. Requested again, the same record gives the same number and
    the same bytes; when its contents have changed, it has a new number and names the one it replaces. A session that is
    not accepted has none.
    """
    paper = hand_out(desk, id, format, now, who=person.signs(by.strip()) or NOT_STATED)
    return _file(paper, format)


@router.get("/{id}/certificates", responses=errors(404, 422))
def list_certificates(id: SessionId, desk: DeskOf) -> Papers:
    """The numbers under which the session's certificate was issued, the first one first, with their signers.

    The last one holds. Its basis is computed again and compared, and `concerns` lists the changes.
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
    id: SessionId, new: NewSignature, _: PasswordTurn, desk: DeskOf, person: PersonOf, now: Now, request: Request
) -> Signature:
    """Sign the session's certificate: that you reviewed it, or that it is approved.

    Asks for the password of your account again. A certificate is reviewed first and approved by somebody else; both
    need the role engineer. An approved certificate is kept as it is, with the laboratory's electronic seal if it has
    one, and the same bytes are handed out from then on.
    """
    signing = Signing(id, new.number, new.meaning, person.login, new.password)
    signature = sign(desk, signing, attempt_of(request, person.login), now)
    return signature


def _file(paper: CertificateDocument, format: str) -> Response:
    media, ending = (XML, "xml") if format == "dcc" else (PDF, "pdf")
    return as_file(paper.content, media, f"{paper.name}.{ending}")


@router.get("/{id}/correction", responses=errors(404, 422))
def read_correction(id: SessionId, storage: StorageOf) -> CorrectionDocument:
    """The correction for firmware: formula, numbers of every sensor, matrix and a worked example, imu-correction/1."""
    return CorrectionDocument.model_validate(correction_document(storage, id))


MOST = 25
"""Certificates of one document: each takes about a fifth of a second, most of it to draw its charts a first time."""

printing_router = APIRouter(prefix="/certificates", tags=["handing on"])


@printing_router.get("", responses={200: {"content": {PDF: BYTES}}, **errors(422, 507)}, response_class=Response)
def print_certificates(
    desk: DeskOf,
    now: Now,
    person: PersonOf,
    session: Annotated[list[Sought], Query(min_length=1, max_length=MOST, description="Ids of sessions.")],
    *,
    by: Annotated[Text, Query(description="Who issues them; kept with their numbers.")] = "",
) -> Response:
    """Certificates to print, one after the other in one PDF.

    Each is issued as if it was asked for by itself. Electronic seals stay with the files of single certificates. If
    one session has none, the answer names it and there is no document.
    """
    paper = hand_out_together(desk, session, now, who=person.signs(by.strip()) or NOT_STATED)
    return as_file(paper.content, PDF, f"{paper.name}.pdf")


labels_router = APIRouter(prefix="/units", tags=["handing on"])
LABEL_PDF, SVG = "application/pdf", "image/svg+xml"
"""Media types of the two forms."""


Due = Annotated[bool, Query(description="Whether it says if the unit may be used and when its calibration is due.")]


@dataclass(frozen=True)
class Labels:
    """Makes labels as this request wants them."""

    request: Request
    store: Store
    settings: Settings
    now: datetime

    def of(self, serial: str, *, due: bool) -> Label:
        """The label of a unit; its address is the public one, or the one that the request was sent to."""
        unit = Fleet(self.store).get(serial)
        base = self.settings.public_url or str(self.request.base_url)
        use = usable_of(self.store, (unit,), self.now)[serial]
        return label_of(unit, use, base, with_due=due)


def _labels(request: Request, store: Reading, settings: SettingsOf, now: Now) -> Labels:
    return Labels(request, store, settings, now)


LabelsOf = Annotated[Labels, Depends(_labels)]


@labels_router.get(
    "/{serial:path}/label.pdf",
    responses={200: {"content": {LABEL_PDF: BYTES}}, **errors(404, 422)},
    response_class=Response,
)
def read_label(serial: Serial, labels: LabelsOf, language: LanguageOf, *, due: Due = True) -> Response:
    """A small label: serial number, `DO NOT USE` or the due date, and a QR code that opens the unit's page.

    Its address is that of the setting `IMU_HEALTH_PUBLIC_URL`, or the one that this request was sent to.
    """
    return as_file(label_pdf(labels.of(serial, due=due), labels.now, language), LABEL_PDF, f"{serial}-label.pdf")


@labels_router.get(
    "/{serial:path}/status.pdf", responses={200: {"content": {PDF: BYTES}}, **errors(404, 422)}, response_class=Response
)
def read_status(serial: Serial, store: Reading, now: Now, language: LanguageOf) -> Response:
    """One page to hand over with the unit: may it be used, next calibration, reservations, what is closest to its
    tolerance, and lines to sign."""
    return as_file(status_pdf(status_paper(store, serial, now), now, language), PDF, f"{serial}-status.pdf")


@labels_router.get(
    "/{serial:path}/label.svg", responses={200: {"content": {SVG: BYTES}}, **errors(404, 422)}, response_class=Response
)
def draw_label(serial: Serial, labels: LabelsOf, language: LanguageOf, *, due: Due = True) -> Response:
    """The unit's label as a drawing, SVG."""
    return as_file(label_svg(labels.of(serial, due=due), language), SVG, f"{serial}-label.svg")
