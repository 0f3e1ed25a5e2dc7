"""The pages of long work: the list, and how far one job has come."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from urllib.parse import quote, urlencode

from estimator.errors import Problem
from service.flows.ask_job import may_cancel
from service.measures import number
from service.pages.follow import SOONEST, follow_seconds
from service.records.failure import Failed
from service.records.identity import Person
from service.records.job import Job, JobFailure, JobKind, JobState
from service.records.model import Scope
from service.words.failed import NAMES
from service.words.jobs import STATES, ending_of, outcome_of, progress_of, title_of

PAGE_SIZE = 50
"""Jobs on a page: more than a week's."""
LATEST = 10
"""Seconds: as long as somebody looks on without wondering."""
TONES = {JobState.DONE: "pass", JobState.FAILED: "fail", JobState.CANCELLED: "none"}
"""Colours of what has ended."""
PLACES = {Scope.UNIT: "units", Scope.UNIT_TYPE: "unit-types", Scope.STAND: "stands"}
"""First parts of the addresses of what a job is about."""
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
    """Work beside the requests that has failed."""

    what: str
    of: str
    why: str


@dataclass(frozen=True)
class JobsPage:
    """Everything the list shows."""

    lines: tuple[JobLine, ...]
    subject: str
    mine: bool
    can_be_mine: bool
    """Whether somebody signed in, so that there are jobs of one's own."""
    earlier: str
    """Address of the next page; empty where there is none."""
    failed: tuple[FailedLine, ...] = ()
    """Work beside the requests that has failed."""


@dataclass(frozen=True)
class JobPage:
    """Everything the page of one job shows."""

    job: Job
    title: str
    state: str
    tone: str
    progress: str
    outcome: str
    ending: str
    about: str
    """Address of what it is about; empty where that is the whole fleet."""
    size: str
    failures: tuple[JobFailure, ...]
    more: int
    """Failures that are not listed."""
    follow: int | None
    """Seconds after which the page looks again."""
    can_cancel: bool
    problems: tuple[Problem, ...]
    """Of an upload that was refused."""


def jobs_page(
    found: Sequence[Job], person: Person, subject: str, *, mine: bool, failed: Sequence[Failed] = ()
) -> JobsPage:
    """The newest first."""
    lines = tuple(map(job_line, found))
    narrowed = ({"subject": subject} if subject else {}) | ({"mine": "yes"} if mine else {})
    earlier = f"/jobs?{urlencode(narrowed | {'before': found[-1].id})}" if len(found) == PAGE_SIZE else ""
    shown = tuple(FailedLine(NAMES[one.kind], one.of, one.why) for one in failed)
    return JobsPage(lines, subject, mine, bool(person.login), earlier, shown)


def job_line(job: Job) -> JobLine:
    """One of a list."""
    said = progress_of(job)
    if job.kind is JobKind.UPLOAD and not job.is_open:
        said = outcome_of(job) or ending_of(job)
    return JobLine(job, title_of(job), STATES[job.state], said)


def job_page(job: Job, person: Person, now: datetime, workers: int, problems: Sequence[Problem] = ()) -> JobPage:
    """One job as it stands."""
    follow = follow_seconds(job.asked_at, now, workers) if job.is_open else None
    latest = SOONEST if job.kind is JobKind.UPLOAD else LATEST
    return JobPage(
        job=job,
        title=title_of(job),
        state=STATES[job.state],
        tone=TONES.get(job.state, "none"),
        progress=progress_of(job),
        outcome=outcome_of(job),
        ending=ending_of(job),
        about=_about(job),
        size="" if job.made is None else f"{number(job.made.size / KILO, 0)} kB",
        failures=job.failures,
        more=job.failed - len(job.failures),
        follow=None if follow is None else min(follow, latest),
        can_cancel=job.is_open and not job.is_storing and may_cancel(job, person),
        problems=tuple(problems),
    )


def _about(job: Job) -> str:
    if job.kind is JobKind.MODEL:
        return f"/models/{job.revision}"
    return "" if job.scope is None else f"/{PLACES[job.scope]}/{quote(job.subject)}"
