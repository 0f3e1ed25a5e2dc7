"""A diagnosis at which the program fails: told as that, logged with its session, and nothing is lost or tried for ever.

The failure is a real one: the stored calibration of the reference, which the verdict is compared with, is damaged.
"""

import io
import json
import zlib
from collections.abc import Iterator
from datetime import UTC, datetime
from threading import Event
from typing import Any

import httpx
import pytest
from sqlalchemy import text

from service.app import create_app
from service.diagnosis.store import Diagnoses
from service.kit.bell import Bell
from service.kit.failure import AT_FAULT
from service.kit.metrics import Metrics
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.sessions.records import DiagnosisState
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from service.work import readers as read_diagnosis
from service.work.helper import Helper
from service.work.kinds import DIAGNOSES, LEASE, MOST_ATTEMPTS
from service.work.loop import Worker, work_next
from tests.conftest import SettingsHolding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import warm
from tests.service.kit.test_log import lines
from tests.service.made_sessions import session_id
from tests.service.pages.test_http import HTML
from tests.serving import http_client

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
REFERENCE, LATER = (json.dumps(warm(m, f"2026-0{m}-05T08:00:00Z")).encode() for m in (1, 3))
OTHER = json.dumps(warm(1, "2026-02-05T08:00:00Z") | {"unit": "another"}).encode()
"""A session of another unit."""
ID = session_id(LATER)
SPOIL = text("UPDATE calibrations SET document = :document WHERE session_id = :id")


@pytest.fixture
def settings(settings_holding: SettingsHolding) -> Settings:
    """Settings of a service that holds two sessions of a unit."""
    return settings_holding(REFERENCE, LATER)


@pytest.fixture
def spoilt(storage: Storage) -> Storage:
    """Stores that hold a session that is not diagnosed yet, and a reference whose calibration is damaged."""
    with storage.database.engine.begin() as connection:
        connection.execute(SPOIL, {"document": zlib.compress(b"{}"), "id": session_id(REFERENCE)})
    return storage


@pytest.fixture
def shown(spoilt: Storage, settings: Settings) -> Iterator[httpx.Client]:
    """HTTP to the service on these stores."""
    with http_client(create_app(settings)) as client:
        yield client


def test_the_verdict_says_that_it_was_not_checked(shown: httpx.Client) -> None:
    shown.get(f"/sessions/{ID}/diagnosis", headers=HTML)
    said = shown.get(f"/api/v1/sessions/{ID}").json()["said"]
    assert said.endswith(", but causes were not checked: see its diagnosis")


def test_the_page_says_that_it_is_a_fault_of_the_program_and_where_to_look(shown: httpx.Client) -> None:
    page = shown.get(f"/sessions/{ID}/diagnosis", headers=HTML)
    assert page.status_code == 200
    assert "a fault of the program, not of the session" in page.text
    assert f"about session {ID}" in page.text
    assert "Error" not in page.text


def test_the_log_says_what_happened_under_the_session(written: io.StringIO, shown: httpx.Client) -> None:
    shown.get(f"/sessions/{ID}/diagnosis", headers=HTML)
    [failure] = [line for line in lines(written) if line["event"] == "background work failed"]
    assert (failure["level"], failure["place"]) == ("error", ID)
    assert "UnreadableError" in failure["exception"]


def test_session_calibration_and_file_are_there_all_the_same(shown: httpx.Client) -> None:
    shown.get(f"/sessions/{ID}/diagnosis", headers=HTML)
    for path in ("", "/calibration", "/file"):
        assert shown.get(f"/api/v1/sessions/{ID}{path}").status_code == 200


def test_this_version_fails_once_for_whoever_reads_and_counts_it(shown: httpx.Client) -> None:
    for _ in range(2):
        assert shown.get(f"/api/v1/sessions/{ID}/diagnosis").status_code == 404
    counted = 'imu_health_background_faults_total{fault="UnreadableError",work="pending diagnoses"} 1.0'
    assert counted in shown.get("/metrics").text


@pytest.fixture
def forgetful(storage: Storage, settings: Settings) -> Iterator[httpx.Client]:
    """HTTP to a service in which only a diagnosis fails: what the reference tells of flags is damaged."""
    with storage.database.engine.begin() as connection:
        connection.execute(text("UPDATE sessions SET tells = '{}' WHERE id = :id"), {"id": session_id(REFERENCE)})
    with http_client(create_app(settings)) as client:
        yield client


def test_a_certificate_states_that_the_program_failed(written: io.StringIO, forgetful: httpx.Client) -> None:
    paper = forgetful.get(f"/api/v1/sessions/{ID}/certificate?format=dcc")
    assert (paper.status_code, "a fault of the program, not of the session" in paper.text) == (200, True)
    [failure] = [line for line in lines(written) if line["event"] == "background work failed"]
    assert (failure["level"], failure["place"]) == ("error", ID)


@pytest.mark.parametrize(
    ("path", "form"),
    [
        (f"/api/v1/sessions/{ID}/diagnosis/accept", {"json": {"cause": "warm-up", "scope": "unit", "by": "K. Ito"}}),
        (f"/sessions/{ID}/diagnosis/accept", {"data": {"cause": "warm-up", "scope": "unit", "by": "K. Ito"}}),
    ],
)
def test_nothing_is_accepted_of_it_and_the_same_is_said(
    forgetful: httpx.Client, path: str, form: dict[str, Any]
) -> None:
    refused = forgetful.post(path, **form)
    assert (refused.status_code, "a fault of the program, not of the session" in refused.text) == (409, True)


def test_what_rests_on_a_diagnosis_that_somebody_is_making_is_asked_for_again(
    storage: Storage, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    id = session_id(REFERENCE)
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.DIAGNOSIS).claim(id, NOW, datetime.now(UTC) + LEASE)
    monkeypatch.setattr(read_diagnosis, "PATIENCE", 0.0)
    with http_client(create_app(settings)) as client:
        answer = client.get(f"/api/v1/sessions/{id}/certificate")
    assert (answer.status_code, answer.headers["Retry-After"]) == (503, "2")


@pytest.mark.slow
def test_what_the_program_fails_at_is_tried_some_times_beside_the_requests(
    written: io.StringIO, spoilt: Storage, settings: Settings
) -> None:
    own, helper = Worker(settings, spoilt, lambda: NOW, Metrics(), Bell()), Helper(settings)
    tries = 0
    while work_next(own, helper.make, Event(), DIAGNOSES):
        tries += 1
    helper.end()
    assert tries == 1 + MOST_ATTEMPTS + 1
    assert f'{{fault="UnreadableError",work="pending diagnoses"}} {float(MOST_ATTEMPTS)}' in own.metrics.text().decode()
    reasons = [line["reason"] for line in lines(written) if line.get("of") == ID and "reason" in line]
    assert reasons == [AT_FAULT] * MOST_ATTEMPTS


@pytest.mark.usefixtures("patient_readers")
def test_one_failure_does_not_keep_the_next_from_its_diagnosis(spoilt: Storage, settings: Settings) -> None:
    upload(spoilt, OTHER, "other.json", NOW)
    with http_client(create_app(settings.model_copy(update={"diagnosis_workers": 1}))) as client:
        for content in (LATER, OTHER):
            client.get(f"/api/v1/sessions/{session_id(content)}/diagnosis")
    with spoilt.database.reading() as store:
        states = [Diagnoses(store).summary(session_id(content)) for content in (OTHER, LATER)]
    assert [state and state.state for state in states] == [DiagnosisState.NAMED, DiagnosisState.FAILED]
