"""The pages of long jobs."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Literal
from urllib.parse import quote, urlencode

from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.errors import Problem
from service.diagnosis.store import Diagnoses
from service.jobs.changes import cancel_job, may_cancel
from service.jobs.records import Job, JobFailure, JobKind, JobState, NewJob
from service.jobs.store import Failures, Jobs
from service.jobs.words import STATES, ending_of, progress_of, title_of
from service.jobs.words import outcome_of as outcome_in_words
from service.kit.failure import NAMES, Failed
from service.kit.measures import number
from service.kit.person import Person
from service.models.records import Scope
from service.people.admission import PersonOf
from service.people.dependencies import SEE_OTHER, By, FormText, Number, StorageOf
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.uploads.pages import FileOutcome, job_outcome, outcome_of, upload_page
from service.uploads.store import Arrivals
from service.web.dependencies import LanguageOf, Now, Reading, SettingsOf
from service.web.fields import Sought
from service.web.render import SOONEST, follow_seconds, render
from service.work.dependencies import JobDeskOf

PAGE_SIZE = 50
"""Jobs on a page: more than a week's."""
MAX_REFRESH_SECONDS = 10
"""Longest interval of the page's refresh, s."""
TONES = {JobState.DONE: "pass", JobState.FAILED: "fail", JobState.CANCELLED: "none"}
"""Colours of ended jobs."""
PLACES = {Scope.UNIT: "units", Scope.UNIT_TYPE: "unit-types", Scope.STAND: "stands"}
"""First parts of the addresses of a job's subject."""
KILO = 1000
"""Bytes in a kilobyte."""


@dataclass(frozen=True)
class JobLine:
    """One job in the list."""

    job: Job
    title: str
    state: str
    progress: str


@dataclass(frozen=True)
class FailedLine:
    """Failed background work."""

    work: str
    subject: str
    why: str


@dataclass(frozen=True)
class JobsPage:
    """Contents of the list."""

    lines: tuple[JobLine, ...]
    subject: str
    mine: bool
    can_be_mine: bool
    """Whether somebody signed in, so that there are jobs of this account."""
    earlier: str
    """Address of the next page; empty where there is none."""
    failed: tuple[FailedLine, ...] = ()
    """Background work that has failed."""


@dataclass(frozen=True)
class JobView:
    """Contents of the page of one job."""

    job: Job
    title: str
    state: str
    tone: str
    progress: str
    outcome: str
    ending: str
    about: str
    """Address of its subject; empty for the whole fleet."""
    size: str
    failures: tuple[JobFailure, ...]
    more: int
    """Failures that are not listed."""
    follow: int | None
    """Seconds after which the page refreshes."""
    can_cancel: bool
    problems: tuple[Problem, ...]
    """Faults of a refused upload."""


def jobs_page(
    jobs: Sequence[Job], person: Person, subject: str, *, mine: bool, failed: Sequence[Failed] = ()
) -> JobsPage:
    """The newest first."""
    lines = tuple(map(job_line, jobs))
    filters = ({"subject": subject} if subject else {}) | ({"mine": "yes"} if mine else {})
    earlier = f"/jobs?{urlencode(filters | {'before': jobs[-1].id})}" if len(jobs) == PAGE_SIZE else ""
    failed_lines = tuple(FailedLine(NAMES[f.kind], f.of, f.why) for f in failed)
    return JobsPage(lines, subject, mine, bool(person.login), earlier, failed_lines)


def job_line(job: Job) -> JobLine:
    """One line of the list."""
    progress = progress_of(job)
    if job.kind is JobKind.UPLOAD and not job.is_open:
        progress = outcome_in_words(job) or ending_of(job)
    return JobLine(job, title_of(job), STATES[job.state], progress)


def job_page(job: Job, person: Person, now: datetime, workers: int, problems: Sequence[Problem] = ()) -> JobView:
    """One job as it stands."""
    follow = follow_seconds(job.asked_at, now, workers) if job.is_open else None
    longest = SOONEST if job.kind is JobKind.UPLOAD else MAX_REFRESH_SECONDS
    return JobView(
        job=job,
        title=title_of(job),
        state=STATES[job.state],
        tone=TONES.get(job.state, "none"),
        progress=progress_of(job),
        outcome=outcome_in_words(job),
        ending=ending_of(job),
        about=_about(job),
        size="" if job.made is None else f"{number(job.made.size / KILO, 0)} kB",
        failures=job.failures,
        more=job.failed - len(job.failures),
        follow=None if follow is None else min(follow, longest),
        can_cancel=job.is_open and not job.is_storing and may_cancel(job, person),
        problems=tuple(problems),
    )


def _about(job: Job) -> str:
    if job.kind is JobKind.MODEL:
        return f"/models/{job.revision}"
    return "" if job.scope is None else f"/{PLACES[job.scope]}/{quote(job.subject)}"


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/jobs")
def show_jobs(
    request: Request,
    store: Reading,
    person: PersonOf,
    now: Now,
    subject: Annotated[Sought, Query()] = "",
    mine: Literal["yes", ""] = "",
    before: Annotated[int | None, Query(ge=1, le=2_000_000_000)] = None,
) -> HTMLResponse:
    """Long work that was asked for, the newest first."""
    account = person.login if mine else ""
    jobs = Jobs(store).page(PAGE_SIZE, before=before, account=account, subject=subject)
    failed = Failures(store).listed(now, PAGE_SIZE)
    return render(request, "jobs.html", jobs_page(jobs, person, subject, mine=bool(account), failed=failed))


@router.post("/jobs/failed/retry")
def retry_failed(by: By, desk: JobDeskOf, storage: StorageOf, now: Now) -> RedirectResponse:
    """Tries again what failed in the background."""
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
    subject: FormText = "",
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
    """Shows the progress of one job."""
    job = Jobs(store).get(id)
    problems = () if job.refusal is None else Arrivals(store).refusal(job.refusal).problems
    return render(request, "job.html", job_page(job, person, now, desk.workers, problems))


@router.get("/jobs/{id}/outcome")
def show_outcome(request: Request, store: Reading, settings: SettingsOf, id: Number) -> HTMLResponse:
    """Outcome of an upload so far, as the card of the upload page."""
    job = Jobs(store).get(id)
    return render(request, "outcome.html", upload_page((_outcome(store, job),), settings))


def _outcome(store: Store, job: Job) -> FileOutcome:
    if job.session:
        return outcome_of(Sessions(store).get(job.session), Diagnoses(store).summary(job.session))
    if job.refusal is not None:
        return FileOutcome(job.subject, problems=Arrivals(store).refusal(job.refusal).problems)
    return job_outcome(job)


@router.post("/jobs/{id}/cancel")
def cancel(id: Number, by: By, storage: StorageOf, person: PersonOf, now: Now) -> RedirectResponse:
    """Stops a job between two pieces, and shows its state."""
    cancel_job(storage, id, person, by, now)
    return RedirectResponse(f"/jobs/{id}", SEE_OTHER)
