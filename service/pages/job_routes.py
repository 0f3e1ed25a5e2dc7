"""The addresses of long work: the list, one job, its file, and the forms that ask for one and cancel it."""

from typing import Annotated, Literal

from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.admission import PersonOf
from service.dependencies import JobDeskOf, LanguageOf, Now, Reading, StorageOf
from service.flows.ask_job import cancel_job
from service.pages.forms import NO_NUL, SEE_OTHER, By, Number
from service.pages.jobs import PAGE_SIZE, job_page, jobs_page
from service.pages.render import render
from service.records.job import JobKind, NewJob
from service.records.model import Scope

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/jobs")
def show_jobs(
    request: Request,
    store: Reading,
    person: PersonOf,
    subject: Annotated[str, Query(max_length=200, pattern=NO_NUL)] = "",
    mine: Literal["yes", ""] = "",
    before: Annotated[int | None, Query(ge=1, le=2_000_000_000)] = None,
) -> HTMLResponse:
    """Long work that was asked for, the newest first."""
    account = person.login if mine else ""
    found = store.jobs.page(PAGE_SIZE, before=before, account=account, subject=subject)
    return render(request, "jobs.html", jobs_page(found, person, subject, mine=bool(account)))


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
    return render(request, "job.html", job_page(store.jobs.get(id), person, now, desk.workers))


@router.post("/jobs/{id}/cancel")
def cancel(id: Number, by: By, storage: StorageOf, person: PersonOf, now: Now) -> RedirectResponse:
    """Stops a job between two pieces, and shows what was done."""
    cancel_job(storage, id, person, by, now)
    return RedirectResponse(f"/jobs/{id}", SEE_OTHER)
