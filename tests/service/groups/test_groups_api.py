"""Findings of a unit, a type or a stand from all sessions together, over HTTP."""

from datetime import UTC, datetime

import httpx
import pytest
from sqlalchemy import text

from service.app import create_app
from service.groups.records import Level
from service.groups.store import Groups
from service.groups.words import FAILED
from service.kit.bell import Bell
from service.kit.metrics import Metrics
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from service.work.kinds import GROUPS as QUEUE
from service.work.kinds import LEASE
from service.work.readers import MOST_WAITING_FOR_GROUPS, GroupReader
from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.grouped import GROUP
from tests.serving import http_client

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
GROUPS = ("units/BA-017", "unit-types/three", "stands/ODG-1")


@pytest.mark.parametrize("path", GROUPS)
def test_a_group_answers_what_its_sessions_show(holding: Holding, path: str) -> None:
    answer = holding(*GROUP[:3]).get(f"/api/v1/{path}/diagnosis").raise_for_status().json()
    assert (answer["format"], answer["id"], answer["sessions"]) == ("imu-fleet-diagnosis/1", path.split("/")[1], 3)
    assert answer["summary"] == "Over 3 sessions: nothing wrong found."
    assert {limit["cause"] for limit in answer["limits"]} >= {"cubic-nonlinearity", "beta-eccentricity"}


@one_engine
@pytest.mark.parametrize("path", ["units/none", "unit-types/none", "stands/none"])
def test_what_does_not_exist_is_not_found(client: httpx.Client, path: str) -> None:
    assert client.get(f"/api/v1/{path}/diagnosis").status_code == 404


@one_engine
def test_what_somebody_is_at_is_202_where_too_many_wait_for_it(settings: Settings, storage: Storage) -> None:
    upload(storage, GROUP[0], "a.json", NOW)
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.GROUP).claim(Groups(store).find(Level.UNIT, "BA-017").place, NOW, NOW + LEASE)
    app = create_app(settings.model_copy(update={"diagnosis_workers": 1}), lambda: NOW)
    for _ in range(MOST_WAITING_FOR_GROUPS):
        app.state.application.part(GroupReader).places.acquire()
    with http_client(app) as client:
        answer = client.get("/api/v1/units/BA-017/diagnosis")
    assert (answer.status_code, "Retry-After" in answer.headers, answer.json()["status"]) == (202, True, "pending")


@one_engine
def test_what_a_group_shows_is_accepted_and_its_progress_told(holding: Holding) -> None:
    client = holding(*GROUP)
    new = {"cause": "cubic-nonlinearity", "by": "K. Ito", "note": "bench"}
    made = client.post("/api/v1/units/BA-017/diagnosis/accept", json=new).raise_for_status().json()
    assert (made["scope"], made["subject"], made["evidence"]["pooled"]["sessions"]) == ("unit", "BA-017", 12)
    told = client.get(f"/api/v1/models/{made['id']}").json()["recomputations"]
    assert [(one["unit"], one["state"], one["outcome"]["recomputed"]) for one in told] == [("BA-017", "done", 12)]
    again = client.post("/api/v1/units/BA-017/diagnosis/accept", json=new | {"cause": "hysteresis"})
    assert (again.status_code, again.json()["problems"][0]["field"]) == (422, "cause")


@one_engine
def test_patience_ends(storage: Storage) -> None:
    upload(storage, GROUP[0], "a.json", NOW)
    reader = GroupReader(storage, lambda: NOW, Bell(), Metrics(), workers=1)
    assert reader.read(Level.UNIT, "BA-017", patience=0.0) is None


@one_engine
def test_an_answer_at_which_the_program_fails_is_kept_as_failed(storage: Storage) -> None:
    upload(storage, GROUP[0], "a.json", NOW)
    metrics = Metrics()
    reader = GroupReader(storage, lambda: NOW, Bell(), metrics, workers=0)
    reader.read(Level.UNIT, "BA-017")
    with storage.database.engine.begin() as connection:
        connection.execute(text("UPDATE session_statistics SET document = :damaged"), {"damaged": b"no stream"})
        connection.execute(text("DELETE FROM group_diagnoses"))
    answers = [reader.read(Level.UNIT, "BA-017") for _ in range(2)]
    assert [answer and answer.summary for answer in answers] == [FAILED] * 2
    assert f'fault="error",work="pending groups"}} {float(QUEUE.most)}' in metrics.text().decode()
