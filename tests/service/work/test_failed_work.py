"""Work beside the requests that fails never reads as "not yet": pages, answers, probes and figures say so and why."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from sqlalchemy import text

from service.judging.usable_words import DATES_PENDING
from service.kit.failure import AT_FAULT
from service.opening import open_database
from service.settings import Settings
from tests.databases import one_engine
from tests.patience import until
from tests.service.made_sessions import session_bytes, session_id
from tests.serving import limited_client

DAMAGED, SOUND = "BA-001", "BA-002"
FIRST = session_bytes(unit=DAMAGED, month=1)


@contextmanager
def served(settings: Settings, workers: int, **limits: float) -> Iterator[httpx.Client]:
    with limited_client(settings.model_copy(update={"diagnosis_workers": workers}), **limits) as client:
        yield client


def send(client: httpx.Client, content: bytes) -> int:
    return client.post("/api/v1/sessions", content=content).status_code


def dated_outlook(client: httpx.Client, unit: str) -> dict[str, Any]:
    """The outlook once it is worked out or has failed; each answer waits for it for a while."""
    for _ in range(20):
        usable = client.get(f"/api/v1/units/{unit}/usable").json()
        if DATES_PENDING not in (*usable["reservations"], *usable["reasons"]):
            break
    found: dict[str, Any] = client.get(f"/api/v1/units/{unit}/outlook").raise_for_status().json()
    return found


def put_histories(settings: Settings, evidence: bytes) -> None:
    """Overwrites the evidence of the first unit on its type, as a fault of the disk may do."""
    database = open_database(settings.database)
    with database.engine.begin() as connection:
        connection.execute(text("UPDATE histories SET evidence = :evidence"), {"evidence": evidence})
    database.close()


def fail_a_forecast(client: httpx.Client, settings: Settings) -> None:
    """The dates of one unit rest on the histories of another one of its type, which nothing writes any more: it is
    diagnosed and dated."""
    files = FIRST, session_bytes(unit=DAMAGED, seed=2, month=2)
    assert [send(client, content) for content in files] == [201, 201]
    diagnoses = [f"/api/v1/sessions/{session_id(content)}/diagnosis" for content in files]
    until(lambda: all(client.get(address).is_success for address in diagnoses))
    assert dated_outlook(client, DAMAGED)["due"]
    put_histories(settings, b"no numbers")
    assert [send(client, session_bytes(unit=SOUND, seed=s, month=s)) for s in (1, 2)] == [201, 201]


@one_engine
@pytest.mark.parametrize("workers", [0, 1])
def test_a_forecast_that_fails_is_told_everywhere(settings: Settings, workers: int) -> None:
    with served(settings, workers) as client:
        fail_a_forecast(client, settings)
        outlook = dated_outlook(client, SOUND)
        usable = client.get(f"/api/v1/units/{SOUND}/usable").json()
        page = client.get(f"/units/{SOUND}", headers={"Accept": "text/html"}).text
        in_russian = client.get(f"/units/{SOUND}?lang=ru", headers={"Accept": "text/html"}).text
        ready, figures = client.get("/readyz"), client.get("/metrics").text
        listed = client.get("/api/v1/jobs/failed").json()["failed"]
        jobs = client.get("/jobs", headers={"Accept": "text/html"}).text
    assert AT_FAULT in outlook["failed"]
    assert "The administrator must act" in outlook["failed"]
    assert outlook["failed"] in usable["reservations"]
    assert AT_FAULT in page
    assert "being computed" not in page
    assert "Нужен администратор" in in_russian
    assert (ready.status_code, ready.json()["status"]) == (200, "ready")
    assert ready.json()["failed"] == {"outlook": 1}
    assert 'imu_health_failed_work{kind="outlook"} 1.0' in figures
    assert listed == [{"kind": "outlook", "of": SOUND, "why": AT_FAULT}]
    assert "Несделанная работа" in jobs  # the language stays


@pytest.mark.usefixtures("patient_readers")
@one_engine
def test_work_that_takes_too_long_is_ended_and_says_so(settings: Settings) -> None:
    """Whatever it is at: nothing keeps a process beside the requests for ever."""
    id, late = session_id(FIRST), "it was not finished within the limit of 0.001 s"
    with served(settings, 1, work=0.001) as client:
        assert send(client, FIRST) == 201
        diagnosis = client.get(f"/api/v1/sessions/{id}/diagnosis").json()
        outlook = dated_outlook(client, DAMAGED)
        in_russian = client.get(f"/sessions/{id}?lang=ru", headers={"Accept": "text/html"}).text
        figures = client.get("/metrics").text
    assert diagnosis["detail"].endswith(f"The last try: {late}.")
    assert late in outlook["failed"]
    assert "не закончено за предельное время 0,001 с" in in_russian
    assert 'fault="TookTooLong",work="pending diagnoses"} 3.0' in figures
    with served(settings, 1) as client:
        assert client.post("/api/v1/jobs/failed/retry").json()["retried"] > 0
        assert client.get(f"/api/v1/sessions/{id}/diagnosis").status_code == 200
        assert not dated_outlook(client, DAMAGED)["failed"]


def test_what_failed_is_tried_again(settings: Settings) -> None:
    with served(settings, 0) as client:
        fail_a_forecast(client, settings)
        put_histories(settings, b"")
        assert client.post("/api/v1/jobs/failed/retry").json() == {"retried": 1}
        outlook = client.get(f"/api/v1/units/{SOUND}/outlook").json()
        assert (outlook["failed"], outlook["due"] is not None) == ("", True)
        assert client.get("/readyz").json()["failed"] == {}


@one_engine
def test_a_diagnosis_whose_file_is_lost_is_told_as_failed(settings: Settings) -> None:
    with served(settings, 0) as client:
        send(client, FIRST)
        for file in settings.files.rglob("*"):
            if file.is_file():
                file.write_bytes(b"damaged")
        id = session_id(FIRST)
        assert client.get(f"/api/v1/sessions/{id}/diagnosis").status_code >= 400
        page = client.get(f"/sessions/{id}", headers={"Accept": "text/html"}).text
        usable = client.get(f"/api/v1/units/{DAMAGED}/usable").json()
        assert client.get("/readyz").json()["failed"] == {"diagnosis": 1}
    assert "Its diagnosis failed" in page
    assert "Its diagnosis failed" in usable["reservation"]
