"""Long work over HTTP: asked for with 202 and an address, followed, fetched, cancelled by who may."""

from datetime import UTC, datetime

import httpx
import pytest

from service.errors import ForbiddenError
from service.jobs.changes import ask_job, cancel_job
from service.jobs.records import JobKind, JobState, NewJob
from service.kit.person import Person, Role
from service.storage import Storage
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it

JOBS = "/api/v1/jobs"
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
AGAIN = {"scope": "unit", "subject": "BA-017", "by": "K. Ito"}


def test_a_report_is_made_kept_and_downloaded(flagged: httpx.Client) -> None:
    asked = flagged.post(f"{JOBS}/report", json={"format": "pdf"})
    assert asked.status_code == 202
    job = flagged.get(asked.headers["Location"]).json()
    file = flagged.get(f"{asked.headers['Location']}/file")
    assert (job["state"], job["done"], file.headers["content-type"]) == ("done", 1, "application/pdf")
    assert (len(file.content), job["made"]["size"]) == (job["made"]["size"], len(file.content))


def test_a_unit_is_computed_again_and_found_in_the_list(flagged: httpx.Client) -> None:
    asked = flagged.post(f"{JOBS}/recalibration", json=AGAIN).json()
    assert (asked["state"], asked["done"], asked["total"], asked["recomputed"]) == ("done", 1, 1, 0)
    for query, found in ({"subject": "BA-017"}, [asked]), ({"subject": "BA-018"}, []), ({"before": asked["id"]}, []):
        assert flagged.get(JOBS, params=query).json()["jobs"] == found


def test_nothing_is_begun_for_a_unit_that_nobody_knows(flagged: httpx.Client) -> None:
    answer = flagged.post(f"{JOBS}/recalibration", json=AGAIN | {"subject": "BA-018"})
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "subject")
    assert flagged.get(JOBS).json()["jobs"] == []


def test_a_job_has_a_file_once_it_is_made(flagged: httpx.Client) -> None:
    job = flagged.post(f"{JOBS}/recalibration", json=AGAIN).json()
    assert flagged.get(f"{JOBS}/{job['id']}/file").status_code == 409
    assert flagged.get(f"{JOBS}/99").status_code == 404


def test_a_waiting_one_is_cancelled_once(storage: Storage, client: httpx.Client) -> None:
    id = ask_job(storage, NewJob(JobKind.REPORT, "K. Ito", form="pdf", language="en"), NOW).id
    cancelled = client.post(f"{JOBS}/{id}/cancel", json={"by": "A. Silva"})
    assert (cancelled.json()["state"], cancelled.json()["cancelled_by"]) == ("cancelled", "A. Silva")
    assert client.post(f"{JOBS}/{id}/cancel", json={"by": "A. Silva"}).status_code == 409


def test_whoever_asked_cancels_it_and_engineers_do(storage: Storage) -> None:
    own, other, engineer = (Person(login, login, role) for login, role in
                            (("ito", Role.VIEWER), ("silva", Role.CREW), ("sato", Role.ENGINEER)))  # fmt: skip
    for person in (own, engineer):
        id = ask_job(storage, NewJob(JobKind.REPORT, "ito", "ito", form="pdf", language="en"), NOW).id
        with pytest.raises(ForbiddenError):
            cancel_job(storage, id, other, "silva", NOW)
        assert cancel_job(storage, id, person, person.name, NOW).state is JobState.CANCELLED
