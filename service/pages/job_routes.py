"""The addresses of long work: the list, one job, its file, and the forms that ask for one and cancel it."""

from typing import Annotated, Literal

from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.admission import PersonOf
from service.dependencies import JobDeskOf, LanguageOf, Now, Reading, SettingsOf, StorageOf
from service.flows.ask_job import cancel_job
from service.pages.forms import NO_NUL, SEE_OTHER, By, Number
from service.pages.jobs import PAGE_SIZE, job_page, jobs_page
from service.pages.render import render
from service.pages.upload import Outcome, job_outcome, outcome_of, upload_page
from service.records.job import Job, JobKind, NewJob
from service.records.model import Scope
from service.storage.store import Store

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/jobs")
def show_jobs(
    request: Request,
    store: Reading,
    person: PersonOf,
    now: Now,
    subject: Annotated[str, Query(max_length=200, pattern=NO_NUL)] = "",
    mine: Literal["yes", ""] = "",
    before: Annotated[int | None, Query(ge=1, le=2_000_000_000)] = None,
) -> HTMLResponse:
    """Long work that was asked for, the newest first."""
    account = person.login if mine else ""
    found = store.jobs.page(PAGE_SIZE, before=before, account=account, subject=subject)
    failed = store.failures.listed(now, PAGE_SIZE)
    return render(request, "jobs.html", jobs_page(found, person, subject, mine=bool(account), failed=failed))


@router.post("/jobs/failed/retry")
def retry_failed(by: By, desk: JobDeskOf, storage: StorageOf, now: Now) -> RedirectResponse:
    """Tries again what failed beside the requests."""
    desk.try_again(storage, now, by)
    return RedirectResponse("/jobs#failed", SEE_OTHER)


@router.post("/jobs/recalibration")
def ask_for_recalibration(
    by: By,
    desk: JobDeskOf,
    storage: StorageOf,
    person: PersonOf,
    *,
    scope: Annotated[Scope | Literal[""], Form()] = "",
    subject: Annotated[str, Form(max_length=200, pattern=NO_NUL)] = "",
) -> RedirectResponse:
    """Has stored sessions computed again, and shows how far that has come."""
    new = NewJob(JobKind.RECALIBRATION, by, person.login, Scope(scope) if scope else None, subject)
    return RedirectResponse(f"/jobs/{desk.ask(storage, new).id}", SEE_OTHER)


@router.post("/jobs/report")
def ask_for_report(
    by: By,
    format: Annotated[Literal["xlsx", "pdf"], Form()],
    desk: JobDeskOf,
    storage: StorageOf,
    person: PersonOf,
    language: LanguageOf,
) -> RedirectResponse:
    """Has a report of the fleet made, and shows how far that has come."""
    new = NewJob(JobKind.REPORT, by, person.login, form=format, language=language.value)
    return RedirectResponse(f"/jobs/{desk.ask(storage, new).id}", SEE_OTHER)


@router.get("/jobs/{id}")
def show_job(request: Request, id: Number, store: Reading, desk: JobDeskOf, person: PersonOf, now: Now) -> HTMLResponse:
    """How far one job has come."""
    job = store.jobs.get(id)
    problems = () if job.refusal is None else store.arrivals.refusal(job.refusal).problems
    return render(request, "job.html", job_page(job, person, now, desk.workers, problems))


@router.get("/jobs/{id}/outcome")
def show_outcome(request: Request, store: Reading, settings: SettingsOf, id: Number) -> HTMLResponse:
    """What became of an upload by now, as the card of the upload page."""
    job = store.jobs.get(id)
    return render(request, "outcome.html", upload_page((_outcome(store, job),), settings))


def _outcome(store: Store, job: Job) -> Outcome:
    if job.session:
        return outcome_of(store.sessions.get(job.session), store.diagnoses.summary(job.session))
    if job.refusal is not None:
        return Outcome(job.subject, problems=store.arrivals.refusal(job.refusal).problems)
    return job_outcome(job)


@router.post("/jobs/{id}/cancel")
def cancel(id: Number, by: By, storage: StorageOf, person: PersonOf, now: Now) -> RedirectResponse:
    """Stops a job between two pieces, and shows what was done."""
    cancel_job(storage, id, person, by, now)
    return RedirectResponse(f"/jobs/{id}", SEE_OTHER)
