"""Stands over HTTP: their own health, and their certificates."""

from datetime import date, datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Query, Request, Response
from pydantic import BaseModel, Field

from service.papers.records import RestingCertificate
from service.papers.store import Certificates
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.stands.changes import record_stand_certificate
from service.stands.dcc import ReadCertificate, read_dcc
from service.stands.records import StandCertificate, StandCondition
from service.stands.store import StandCertificates, Stands
from service.web.dependencies import Now, Reading
from service.web.fields import Body, Day, Name, StandName
from service.web.files import BINARY, BY_HEADER, as_table, table_of, wanted_form
from service.web.problem_document import errors
from service.work.dependencies import ReadingFleet


class StandList(BaseModel):
    """All stands, by name."""

    stands: tuple[StandCondition, ...] = Field(description="The stands.")


class NewStandCertificate(Body):
    """The certificate of a stand's own calibration."""

    number: Name = Field(description="As printed on it; one of a number that is there takes its place.")
    issued_by: Name = Field(description="The laboratory that calibrated the stand.")
    issued_on: Day = Field(description="From this day on it speaks for the stand.", examples=["2026-01-10"])
    valid_until: Day = Field(description="The last day on which it holds.", examples=["2027-01-10"])
    by: Name = Field(description="Your name.")


class StandCertificateList(BaseModel):
    """The certificates of one stand, oldest first."""

    certificates: tuple[StandCertificate, ...] = Field(description="As they were last recorded.")


FIRST_DAY, LAST_DAY = date(1900, 1, 1), date(2999, 12, 31)


class RestingCertificateList(BaseModel):
    """Certificates whose numbers rest on a stand, in order of measurement."""

    certificates: tuple[RestingCertificate, ...] = Field(description="Every issue, replaced ones too.")


FORMS = {"application/json": "json", "text/csv": "csv"}
RESTING = {
    "number": str, "unit": str, "session": str, "started_at": datetime, "issued_at": datetime,
    "is_measured_there": bool,
}  # fmt: skip

DCC_BODY = {"requestBody": {"required": True, "content": {"application/xml": {"schema": {"type": "string"}}}}}

router = APIRouter(prefix="/stands", tags=["stands"])


@router.get("", responses=errors())
def list_stands(store: ReadingFleet) -> StandList:
    """Every stand: whether it shifts all units that are measured on it, since when, by how much."""
    return StandList(stands=Stands(store).conditions())


@router.get("/{name:path}/certificates", responses=errors(404, 422))
def list_stand_certificates(name: StandName, store: Reading) -> StandCertificateList:
    """The certificates of a stand's own calibration, oldest first; sessions are traceable while one holds."""
    found = StandCertificates(store).known(name)
    return StandCertificateList(certificates=found)


@router.get(
    "/{name:path}/resting-certificates",
    responses={200: {"content": {"text/csv": BINARY}}, **errors(404, 422)},
    response_model=RestingCertificateList,
)
def list_resting_certificates(
    request: Request,
    name: StandName,
    store: Reading,
    since: Annotated[date, Query(description="First day of measurement.")] = FIRST_DAY,
    until: Annotated[date, Query(description="Last day of measurement.")] = LAST_DAY,
    format: Annotated[
        Literal["json", "csv"] | None,
        Query(description="Form of the answer; without it the header `Accept` chooses, else it is JSON."),
    ] = None,
) -> Response:
    """Every certificate to look at again where the stand was at fault: of sessions on it, or with a reference on it."""
    StandCertificates(store).known(name)
    found = Certificates(store).resting_on(name, since, until)
    form = wanted_form(request, format, FORMS)
    if form == "csv":
        return as_table(table_of([vars(certificate) for certificate in found], RESTING), form, "resting-certificates")
    document = RestingCertificateList(certificates=found).model_dump_json()
    return Response(document, media_type="application/json", headers=BY_HEADER)


@router.put("/{name:path}/certificate", responses=errors(400, 404, 422))
def put_stand_certificate(
    name: StandName, new: NewStandCertificate, storage: StorageOf, now: Now, person: PersonOf
) -> StandCertificate:
    """Record the certificate of a stand's own calibration; a session is judged by the one of its day."""
    given = StandCertificate(name, new.number, new.issued_by, new.issued_on, new.valid_until)
    return record_stand_certificate(storage, given, now, who=person.signs(new.by))


async def _document(request: Request) -> bytes:
    return await request.body()


@router.put("/{name:path}/certificate-document", responses=errors(400, 404, 413, 422), openapi_extra=DCC_BODY)
def put_stand_certificate_document(
    name: StandName,
    content: Annotated[bytes, Depends(_document)],
    by: Annotated[Name, Query(description="Your name.")],
    storage: StorageOf,
    now: Now,
    person: PersonOf,
    valid_until: Annotated[Day | None, Query(description="The last day, where the document does not state it.")] = None,
) -> ReadCertificate:
    """Record the certificate of a stand from its Digital Calibration Certificate: number, laboratory, days, and the
    uncertainties of the stand's errors, which templates of sessions on it state from then on."""
    read = read_dcc(content, name, valid_until)
    record_stand_certificate(storage, read.certificate, now, who=person.signs(by), errors=read.errors)
    return read
