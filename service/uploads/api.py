"""Uploads over HTTP: list of uploads, previews of layouts, templates, large files processed later.

Without a preference, and for a small file or one that is stored already, the answer is the usual one.
"""

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Path, Query, Request, Response
from fastapi.responses import JSONResponse
from pydantic import BaseModel, Field, TypeAdapter

from estimator.json_object import Json
from service.errors import NotFoundError
from service.ingest.layout.kinds import KINDS, kinds_of
from service.jobs.records import Job, JobKind, under_way
from service.jobs.store import Jobs
from service.kit.arriving_files import where
from service.kit.limits import in_force
from service.kit.person import Person
from service.languages.language import asked
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.planning.pattern import pattern
from service.planning.question import PlanQuestion
from service.records.reception import Reception
from service.sessions.records import StoredSession
from service.sessions.schemas import SaidSession, said_session
from service.sessions.sent import SentFile
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.uploads.preview import felt_length, first_rows, preview
from service.uploads.received import REQUEST_BODY, FileOf
from service.uploads.records import Arrival, ArrivalQuery, Refusal, job_number, refusal_number
from service.uploads.store import Arrivals
from service.uploads.take_in import is_long
from service.uploads.template import session_template
from service.web.dependencies import Now, Reading
from service.web.fields import Limit, Sought
from service.web.files import BINARY, XLSX, as_file
from service.web.problem_document import Fault, errors, faults
from service.work.api import JobAnswer, job_answer
from service.work.dependencies import JobDeskOf
from service.work.job_desk import JobDesk


class UploadSchema(BaseModel):
    """One file that came in: it was stored as a session, or refused and nothing of it stored, or a job works on it."""

    id: str = Field(description="The session's id, or `r` and the number of the refusal, or `j` and that of its job.")
    at: datetime = Field(description="When it came, UTC.")
    filename: str = Field(description="What the file was called.")
    sha256: str = Field(description="SHA-256 of its bytes.")
    size: int = Field(description="Bytes.")
    stored: bool = Field(description="Whether it became a session.")
    session: SaidSession | None = Field(description="The session that it became.")
    problems: list[Fault] = Field(description="Why it was refused: every fault with its place.")
    job: str = Field(default="", description="Address of the job that works, or worked, on it.")


def job_upload_schema(job: Job, session: StoredSession | None, refusal: Refusal | None) -> UploadSchema:
    """An upload with a job, and its result where known."""
    address = f"/api/v1/jobs/{job.id}"
    if session is not None or refusal is not None:
        arrival = Arrival(job.asked_at, session, refusal)
        return upload_schema(arrival).model_copy(update={"job": address})
    assert job.sent is not None
    return UploadSchema(
        id=under_way(job.id), at=job.asked_at, filename=job.subject, sha256=job.sent.sha256, size=job.sent.size,
        stored=False, session=None, problems=[], job=address,
    )  # fmt: skip


class UploadPage(BaseModel):
    """Uploads, newest first."""

    under_way: list[UploadSchema] = Field(
        description="What came in and a job still works on: all of it where the list begins, none where it goes on, or "
        "where `refused` ones are asked for."
    )
    uploads: list[UploadSchema] = Field(description="What came in and was stored or refused.")
    next_after: str | None = Field(description="The list goes on with `after` this; null at its end.")


def upload_schema(arrival: Arrival) -> UploadSchema:
    """An upload as an answer of the API."""
    file: Refusal | StoredSession | None = arrival.refusal or arrival.session
    assert file is not None, "an arrival is one of the two"
    problems = () if arrival.refusal is None else arrival.refusal.problems
    return UploadSchema(
        id=arrival.name,
        at=arrival.at,
        filename=file.filename,
        sha256=file.sha256,
        size=file.size,
        stored=arrival.session is not None,
        session=None if arrival.session is None else said_session(arrival.session),
        problems=faults(problems),
    )


router = APIRouter(prefix="/uploads", tags=["sessions"])
FileName = Annotated[Sought | None, Query(alias="q", description="Part of the file's name.")]
Refused = Annotated[bool, Query(description="Only those that were refused.")]
UploadId = Annotated[
    Sought, Path(description="A session's id, or `r` and the number of a refusal, or `j` and that of a job.")
]
After = Annotated[
    Sought | None, Query(description="The list goes on after this upload: `next_after` of the last answer.")
]


@router.get("", responses=errors(422))
def list_uploads(
    store: Reading, text: FileName = None, refused: Refused = False, after: After = None, limit: Limit = 100
) -> UploadPage:
    """Every file that came in, newest first, with its outcome; those in a running job are listed apart."""
    refusal = refusal_number(after or "")
    session = after if refusal is None else None
    query = ArrivalQuery(text, refused, after_session=session, after_refusal=refusal, limit=limit + 1)
    jobs = () if after or refused else Jobs(store).open_uploads(text)
    arrivals = Arrivals(store).page(query)  # after the jobs: a file that ends meanwhile is in both, not in neither
    shown = arrivals[:limit]
    return UploadPage(
        under_way=[job_upload_schema(job, None, None) for job in jobs],
        uploads=[upload_schema(arrival) for arrival in shown],
        next_after=shown[-1].name if len(arrivals) > limit else None,
    )


@router.get("/{id}", responses=errors(404, 422))
def read_upload(id: UploadId, store: Reading) -> UploadSchema:
    """The outcome of one file; for a refused one, every fault with its place."""
    refusal, job = refusal_number(id), job_number(id)
    if job is not None:
        return _by_job(store, job)
    if refusal is not None:
        refused = Arrivals(store).refusal(refusal)
        return upload_schema(Arrival(refused.at, None, refused))
    session = Sessions(store).get(id)
    return upload_schema(Arrival(session.uploaded_at, session, None))


def _by_job(store: Store, number: int) -> UploadSchema:
    job = Jobs(store).get(number)
    if job.kind is not JobKind.UPLOAD:
        raise NotFoundError("Job {number} takes in no upload.", number=number)
    session = Sessions(store).get(job.session) if job.session else None
    return job_upload_schema(job, session, None if job.refusal is None else Arrivals(store).refusal(job.refusal))


PREFER, ASYNC = "Prefer", "respond-async"
"""Header and preference of RFC 7240."""
ACCEPTED = 202
JSON = TypeAdapter(JobAnswer)


@dataclass(frozen=True)
class Later:
    """Preference of a request for an early answer."""

    is_asked_for: bool
    longer_than: int
    desk: JobDesk
    person: Person

    def is_for(self, file: SentFile, reception: Reception) -> bool:
        """Whether this file is processed later."""
        return self.is_asked_for and is_long(reception.storage, file, self.longer_than)

    def accepted(self, file: SentFile, reception: Reception) -> JSONResponse:
        """The job, with its address, where the result of the upload is shown too."""
        job = self.desk.take_in(reception, file, self.person)
        headers = {"Location": f"/api/v1/jobs/{job.id}", "Preference-Applied": ASYNC}
        return JSONResponse(JSON.dump_python(job_answer(job), mode="json"), ACCEPTED, headers)


def _later(request: Request, desk: JobDeskOf, person: PersonOf) -> Later:
    preferences = ",".join(request.headers.getlist(PREFER)).lower().split(",")
    is_preferred = any(preference.split(";")[0].strip() == ASYNC for preference in preferences)
    return Later(is_preferred, in_force().later, desk, person)


LaterOf = Annotated[Later, Depends(_later)]
"""Whether the sender wants a large file to be processed later, and the answer in that case."""


class LayoutColumn(BaseModel):
    """One column as in the file."""

    heading: str = Field(description="As it stands, joined where there are two rows of headings.")
    cells: list[str] = Field(description="The first ones.")
    numeric: bool = Field(description="Whether most of its cells are numbers.")
    empty: bool = Field(description="Whether no cell says anything.")
    words: list[str] = Field(description="The different texts of a column with few of them.")
    kind: str = Field(description=f"What it is by the mapping: {', '.join(KINDS)}.")


class PreviewSchema(BaseModel):
    """A table under a mapping; correct the mapping and send it again, or with the file to `POST /sessions`."""

    mapping: Json = Field(description="imu-mapping/1, complete as it is to be sent.")
    remembered: bool = Field(description="Whether it is that of an earlier file with the same headings.")
    fingerprint: str = Field(description="SHA-256 of the headings.")
    rows: int = Field(description="Of the file.")
    sheets: list[str] = Field(description="Of a workbook.")
    columns: list[LayoutColumn] = Field(description="Of the file, in its order.")
    lines: list[str] = Field(description="First lines of a text that cannot be cut by `mapping.table` yet.")
    problems: list[Fault] = Field(description="What is missing or cannot be read yet; empty when it can be stored.")
    so_far: list[str] = Field(description="What the session still lacks: positions, and parameters open until then.")
    first_rows: list[dict[str, float | str]] = Field(
        description="As they will be read, SI: angles in rad, sensors in m/s² or rad/s."
    )
    felt: float | None = Field(
        description="Length of the first row's vector by the nominal axes: about 9.8 m/s² at rest."
    )


layouts_router = APIRouter(prefix="/layouts", tags=["sessions"])
Unit = Annotated[Sought, Query(description="Whose last session says what the file does not.")]
UnitType = Annotated[Sought, Query(description="The last session of this stored type says it.")]


@layouts_router.post("/preview", responses=errors(400, 413, 422), openapi_extra=REQUEST_BODY)
def preview_layout(file: FileOf, storage: StorageOf, unit: Unit = "", unit_type: UnitType = "") -> PreviewSchema:
    """The reading of a table of custom layout, by the recognised mapping or by `mapping`. Nothing is stored."""
    result = preview(
        storage,
        where(file.content),
        file.filename,
        mapping=file.mapping,
        unit=unit.strip(),
        unit_type=unit_type.strip(),
    )
    look, session = result.seen, result.session
    kinds = kinds_of([column.get("as") for column in result.mapping["columns"]], result.mapping["session"])
    return PreviewSchema(
        mapping=result.mapping,
        remembered=result.remembered,
        fingerprint=result.fingerprint,
        rows=look["rows"],
        sheets=list(look["sheets"]),
        columns=[
            LayoutColumn.model_validate({**column, "kind": kind})
            for column, kind in zip(look["columns"], kinds, strict=True)
        ],
        lines=look["lines"],
        problems=faults(result.problems),
        so_far=[] if result.so_far is None else list(result.so_far.said),
        first_rows=[] if session is None else first_rows(session),
        felt=None if session is None else felt_length(session),
    )


templates_router = APIRouter(tags=["sessions"])
TemplateUnit = Annotated[
    Sought, Query(description="Made like the last session of this serial number, where it has one.")
]
TemplateType = Annotated[Sought, Query(description="Made for this stored type, like the last session of its units.")]
Kind = Annotated[Literal["accelerometer", "gyroscope"], Query(description="Without a unit and a type: of the sensors.")]
Sensors = Annotated[int, Query(ge=3, le=12, description="Without a unit and a type: how many.")]


@templates_router.get(
    "/session-template", responses={200: {"content": {XLSX: BINARY}}, **errors(404, 422)}, response_class=Response
)
def read_template(
    request: Request,
    storage: StorageOf,
    now: Now,
    *,
    unit: TemplateUnit = "",
    unit_type: TemplateType = "",
    kind: Kind = "accelerometer",
    sensors: Sensors = 6,
) -> Response:
    """A workbook to fill in and upload as it is: sensors, stand and schedule are there, with units and choices. In the
    language of `?lang=`, or of Accept-Language."""
    block = PlanQuestion.model_validate({"kind": kind, "sensors": sensors})
    source = pattern(storage, unit.strip(), unit_type.strip(), block, now.date())
    name = unit.strip() or unit_type.strip() or f"{sensors}-{kind}s"
    language = asked(request.scope)
    response = as_file(session_template(source, now, language), XLSX, f"session-{name}.xlsx")
    response.headers["Content-Language"] = language.value
    return response
