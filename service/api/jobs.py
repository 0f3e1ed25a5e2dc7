"""Long work: asked for, followed, cancelled, and the file that it made."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Response

from service.admission import PersonOf
from service.api.exports import BINARY, as_file
from service.api.fleet import PDF, XLSX
from service.api.schemas.fields import Number, Text
from service.api.schemas.jobs import (
    Cancelling,
    FailedWorkPage,
    JobAnswer,
    JobPage,
    NewRecalibration,
    NewReport,
    RetriedSchema,
    job_answer,
)
from service.api.schemas.problem import errors
from service.dependencies import CREW, JobDeskOf, LanguageOf, Now, Reading, StorageOf
from service.flows.ask_job import cancel_job, file_of
from service.records.job import Job, JobKind, NewJob

router = APIRouter(prefix="/jobs", tags=["jobs"])
ACCEPTED: dict[int | str, dict[str, Any]] = {
    202: {"headers": {"Location": {"schema": {"type": "string"}, "description": "Where the job is followed."}}}
}
MEDIA_TYPES = {"xlsx": XLSX, "pdf": PDF}


@router.get("", responses=errors(422))
def list_jobs(
    store: Reading,
    person: PersonOf,
    mine: Annotated[bool, Query(description="Only what this account asked for.")] = False,
    subject: Annotated[Text, Query(description="Only about this unit, unit type or stand.")] = "",
    before: Annotated[int | None, Query(ge=1, le=2_000_000_000, description="Only jobs before this one.")] = None,
    limit: Annotated[int, Query(ge=1, le=500, description="How many.")] = 100,
) -> JobPage:
    """Long work that was asked for, the newest first."""
    account = person.login if mine else ""
    found = store.jobs.page(limit, before=before, account=account, subject=subject)
    return JobPage(jobs=list(map(job_answer, found)), before=found[-1].id if len(found) == limit else None)


@router.get("/failed", responses=errors(422))
def list_failed(
    store: Reading, now: Now, limit: Annotated[int, Query(ge=1, le=500, description="How many.")] = 100
) -> FailedWorkPage:
    """Work beside the requests that has failed, and why. Jobs and messages are listed for a week after they ended."""
    counts = {kind: number for kind, number in store.failures.counts(now).items() if number}
    listed = store.failures.listed(now, limit)
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
    own = NewJob(JobKind.RECALIBRATION, person.signs(new.by or CREW), person.login, new.scope, new.subject)
    return _accepted(response, desk.ask(storage, own))


@router.post("/report", status_code=202, responses={**ACCEPTED, **errors(400, 422, 503)})
def ask_for_report(
    new: NewReport, response: Response, desk: JobDeskOf, storage: StorageOf, person: PersonOf, language: LanguageOf
) -> JobAnswer:
    """Have a report of the whole fleet made; it is kept for a week."""
    own = NewJob(JobKind.REPORT, person.signs(new.by or CREW), person.login, form=new.format, language=language.value)
    return _accepted(response, desk.ask(storage, own))


@router.get("/{id}", responses=errors(404, 422))
def read_job(id: Number, store: Reading) -> JobAnswer:
    """How far one job has come."""
    job = store.jobs.get(id)
    return job_answer(job, () if job.refusal is None else store.arrivals.refusal(job.refusal).problems)


@router.get(
    "/{id}/file",
    responses={200: {"content": {XLSX: BINARY, PDF: BINARY}}, **errors(404, 409, 422)},
    response_class=Response,
)
def download_result(id: Number, store: Reading, storage: StorageOf) -> Response:
    """What a job made, while it is kept."""
    job = store.jobs.get(id)
    content = file_of(storage.files, job)
    assert job.made is not None
    return as_file(content, MEDIA_TYPES[job.form], job.made.filename)


@router.post("/{id}/cancel", responses=errors(400, 403, 404, 409, 422))
def cancel(id: Number, asked: Cancelling, storage: StorageOf, person: PersonOf, now: Now) -> JobAnswer:
    """Stop a job between two pieces of its work. What was done stays."""
    return job_answer(cancel_job(storage, id, person, person.signs(asked.by or CREW), now))


def _accepted(response: Response, job: Job) -> JobAnswer:
    response.headers["Location"] = f"/api/v1/jobs/{job.id}"
    return job_answer(job)
