"""Long work over HTTP."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, Field

from estimator.errors import Problem
from estimator.json_object import Json
from service.jobs.changes import cancel_job, file_of
from service.jobs.records import Job, JobKind, NewJob
from service.jobs.store import Failures, Jobs
from service.kit.answer import answer
from service.kit.failure import Failed, FailedKind
from service.models.records import Scope
from service.people.admission import PersonOf
from service.people.dependencies import CREW, StorageOf
from service.uploads.store import Arrivals
from service.web.dependencies import LanguageOf, Now, Reading
from service.web.fields import Body, Number, Sought, Text
from service.web.files import BINARY, PDF, XLSX, as_file
from service.web.problem_document import Fault, errors, faults
from service.work.dependencies import JobDeskOf


class NewRecalibration(Body):
    """Stored sessions that are to be computed again under the models in force."""

    scope: Scope | None = Field(None, description="One unit, one unit type or one stand; none for the whole fleet.")
    subject: Text = Field("", description="Its serial number or name; empty for the whole fleet.")
    by: Text = Field("", description="Who asks, where nobody signs in.")


class FailedWorkPage(BaseModel):
    """Work beside the requests that has failed."""

    counts: dict[FailedKind, int] = Field(description="How much of each kind; kinds without any are left out.")
    failed: tuple[Failed, ...] = Field(description="By kind and name.")


class RetriedSchema(BaseModel):
    """Amount of work that is tried again."""

    retried: int = Field(description="How many pieces of work.")


class NewReport(Body):
    """A report of the whole fleet that is to be made."""

    format: Literal["xlsx", "pdf"] = Field(description="Workbook or paper.")
    by: Text = Field("", description="Who asks, where nobody signs in.")


class Cancelling(Body):
    """Cancellation of a job."""

    by: Text = Field("", description="Who cancels, where nobody signs in.")


@answer
@dataclass(frozen=True, kw_only=True)
class JobAnswer(Job):
    """Long work, as it stands."""

    problems: tuple[Fault, ...]
    """Faults of a refused upload, where one job is read."""


class JobPage(BaseModel):
    """Jobs, the newest first."""

    jobs: list[JobAnswer] = Field(description="The jobs of this page.")
    before: int | None = Field(description="Ask with it for the jobs before these; none where there are none.")


def job_answer(job: Job, problems: Iterable[Problem] = ()) -> JobAnswer:
    """A job as an answer of the API, with the problems of a refused file."""
    return JobAnswer(**vars(job), problems=tuple(faults(problems)))


router = APIRouter(prefix="/jobs", tags=["jobs"])
ACCEPTED: dict[int | str, Json] = {
    202: {"headers": {"Location": {"schema": {"type": "string"}, "description": "Where the job is followed."}}}
}
MEDIA_TYPES = {"xlsx": XLSX, "pdf": PDF}


@router.get("", responses=errors(422))
def list_jobs(
    store: Reading,
    person: PersonOf,
    mine: Annotated[bool, Query(description="Only what this account asked for.")] = False,
    subject: Annotated[Sought, Query(description="Only about this unit, unit type or stand.")] = "",
    before: Annotated[int | None, Query(ge=1, le=2_000_000_000, description="Only jobs before this one.")] = None,
    limit: Annotated[int, Query(ge=1, le=500, description="How many.")] = 100,
) -> JobPage:
    """Long work that was asked for, the newest first."""
    account = person.login if mine else ""
    jobs = Jobs(store).page(limit, before=before, account=account, subject=subject)
    return JobPage(jobs=list(map(job_answer, jobs)), before=jobs[-1].id if len(jobs) == limit else None)


@router.get("/failed", responses=errors(422))
def list_failed(
    store: Reading, now: Now, limit: Annotated[int, Query(ge=1, le=500, description="How many.")] = 100
) -> FailedWorkPage:
    """Work beside the requests that has failed, and why. Jobs and messages are listed for a week after they ended."""
    counts = {kind: number for kind, number in Failures(store).counts(now).items() if number}
    listed = Failures(store).listed(now, limit)
    return FailedWorkPage(counts=counts, failed=listed)


@router.post("/failed/retry", responses=errors(422))
def retry_failed(storage: StorageOf, now: Now, desk: JobDeskOf, person: PersonOf) -> RetriedSchema:
    """Try again everything that failed and is still wanted, apart from jobs and messages, which have ended."""
    return RetriedSchema(retried=desk.try_again(storage, now, person.signs(CREW)))


@router.post("/recalibration", status_code=202, responses={**ACCEPTED, **errors(400, 422, 503)})
def ask_for_recalibration(
    new: NewRecalibration, response: Response, desk: JobDeskOf, storage: StorageOf, person: PersonOf
) -> JobAnswer:
    """Have stored sessions computed again under the models in force, unit by unit. Nothing is overwritten."""
    job = NewJob(JobKind.RECALIBRATION, person.signs(new.by or CREW), person.login, new.scope, new.subject)
    return _accepted(response, desk.ask(storage, job))


@router.post("/report", status_code=202, responses={**ACCEPTED, **errors(400, 422, 503)})
def ask_for_report(
    new: NewReport, response: Response, desk: JobDeskOf, storage: StorageOf, person: PersonOf, language: LanguageOf
) -> JobAnswer:
    """Have a report of the whole fleet made; it is kept for a week."""
    job = NewJob(JobKind.REPORT, person.signs(new.by or CREW), person.login, form=new.format, language=language.value)
    return _accepted(response, desk.ask(storage, job))


@router.get("/{id}", responses=errors(404, 422))
def read_job(id: Number, store: Reading) -> JobAnswer:
    """The progress of one job."""
    job = Jobs(store).get(id)
    return job_answer(job, () if job.refusal is None else Arrivals(store).refusal(job.refusal).problems)


@router.get(
    "/{id}/file",
    responses={200: {"content": {XLSX: BINARY, PDF: BINARY}}, **errors(404, 409, 422)},
    response_class=Response,
)
def download_result(id: Number, store: Reading, storage: StorageOf) -> Response:
    """The file that a job made, while it is kept."""
    job = Jobs(store).get(id)
    content = file_of(storage.files, job)
    assert job.made is not None
    return as_file(content, MEDIA_TYPES[job.form], job.made.filename)


@router.post("/{id}/cancel", responses=errors(400, 403, 404, 409, 422))
def cancel(id: Number, asked: Cancelling, storage: StorageOf, person: PersonOf, now: Now) -> JobAnswer:
    """Stop a job between two pieces of its work. Finished pieces stay."""
    return job_answer(cancel_job(storage, id, person, person.signs(asked.by or CREW), now))


def _accepted(response: Response, job: Job) -> JobAnswer:
    response.headers["Location"] = f"/api/v1/jobs/{job.id}"
    return job_answer(job)
