"""The pages of long work: what is asked for is found again, follows by itself, and says what it did."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import httpx
import pytest

from service.jobs.changes import ask_job
from service.jobs.records import Job, JobFailure, JobKind, JobState, NewJob
from service.kit.person import EVERYBODY, LOOKING
from service.models.records import Scope
from service.storage import Storage
from service.work.pages import MAX_REFRESH_SECONDS, job_page
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
HTML = {"Accept": "text/html"}


@pytest.fixture
def job(storage: Storage) -> Job:
    """One that nobody is at."""
    return ask_job(storage, NewJob(JobKind.RECALIBRATION, "K. Ito"), NOW)


def test_a_report_is_asked_for_by_a_form_and_linked_where_it_is_made(client: httpx.Client) -> None:
    form = {"format": "xlsx", "by": "K. Ito"}
    page = client.post("/jobs/report", data=form, headers=HTML, follow_redirects=True).text
    assert "Fleet report as a workbook" in page
    assert 'href="/api/v1/jobs/1/file"' in page
    assert 'href="/jobs/1"' in client.get("/jobs", headers=HTML).text


def test_an_open_one_is_cancelled_by_a_form(client: httpx.Client, job: Job) -> None:
    assert "<progress" in client.get(f"/jobs/{job.id}", headers=HTML).text
    page = client.post(f"/jobs/{job.id}/cancel", data={"by": "A. Silva"}, headers=HTML, follow_redirects=True).text
    assert "Cancelled by A. Silva" in page
    assert "<progress" not in page


def test_a_page_follows_ever_more_slowly_until_the_end(job: Job) -> None:
    follows = [job_page(job, EVERYBODY, NOW + timedelta(seconds=s), 1).follow for s in (0, 10, 1000)]
    assert follows == [2, 5, MAX_REFRESH_SECONDS]
    ended = replace(job, state=JobState.DONE)
    assert [job_page(one, EVERYBODY, NOW, workers).follow for one, workers in ((ended, 1), (job, 0))] == [None, None]


def test_who_looks_only_is_offered_no_cancelling(job: Job) -> None:
    assert [job_page(job, person, NOW, 1).can_cancel for person in (EVERYBODY, LOOKING)] == [True, False]


def test_what_could_not_be_done_is_counted_beyond_what_is_listed(job: Job) -> None:
    failed = replace(job, state=JobState.DONE, scope=Scope.STAND, subject="ODG 1", failed=3,
                     failures=(JobFailure("B-1", "lost"),))  # fmt: skip
    page = job_page(failed, EVERYBODY, NOW, 1)
    assert (page.more, page.about) == (2, "/stands/ODG%201")
