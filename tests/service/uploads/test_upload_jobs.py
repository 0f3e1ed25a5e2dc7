"""A large upload whose sender asks for it is acknowledged with its job; who does not ask gets the answers of old."""

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import httpx
import pytest

from service.app import create_app
from service.kit.person import EVERYBODY
from service.sessions.sent import SentFile
from service.settings import Settings
from service.storage import Storage
from service.storage.schema import upgrade
from service.storage.waiting import FOLDER
from service.uploads.take_in import ask_upload
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes
from tests.serving import http_client, limited_client

SESSIONS, UPLOAD = "/api/v1/sessions", {"files": {"file": ("log.json", session_bytes())}}
LATER = {"Prefer": "handling=strict, respond-async; wait=10"}
OWN = b"Run;Ch 1, mV\ndirect;437,0\nflipped;-437,2\n"


@pytest.fixture
def client(settings: Settings) -> Iterator[httpx.Client]:
    """A service to which every file is a large one."""
    with limited_client(settings, later=100) as client:
        yield client


@pytest.fixture
def usual(settings: Settings) -> Iterator[httpx.Client]:
    """One with the usual settings."""
    with http_client(create_app(settings)) as client:
        yield client


@pytest.fixture
def waiting(storage: Storage) -> None:
    """A file that was received, and that nobody is at."""
    ask_upload(storage, SentFile("a.json", session_bytes()), EVERYBODY, "one", datetime(2026, 11, 21, 12, tzinfo=UTC))


def test_it_is_answered_with_the_addresses_of_job_and_upload(client: httpx.Client) -> None:
    asked = client.post(SESSIONS, headers=LATER, **UPLOAD)
    assert (asked.status_code, asked.headers["Preference-Applied"]) == (202, "respond-async")
    job = client.get(asked.headers["Location"]).json()
    upload = client.get(f"/api/v1/uploads/{job['upload']}").json()
    assert (job["state"], job["subject"], upload["session"]["id"]) == ("done", "log.json", job["session"])
    assert client.get(f"{SESSIONS}/{job['session']}/file").content == session_bytes()


def test_who_does_not_ask_and_who_sends_little_or_again_is_answered_at_once(
    client: httpx.Client, usual: httpx.Client
) -> None:
    assert client.post(SESSIONS, **UPLOAD).status_code == 201
    assert client.post(SESSIONS, headers=LATER, **UPLOAD).status_code == 200
    other = usual.post(SESSIONS, headers=LATER, content=session_bytes(seed=2))
    assert (other.status_code, other.json()["created"]) == (201, True)


def test_the_session_is_the_one_of_a_plain_upload(client: httpx.Client, tmp_path: Path) -> None:
    job = client.post(SESSIONS, headers=LATER, content=session_bytes()).json()
    other = Settings(data_folder=tmp_path)
    upgrade(other.database)
    with http_client(create_app(other)) as plain:
        at_once = plain.post(SESSIONS, content=session_bytes()).json()["id"]
        stored = [client.get(f"{SESSIONS}/{job['session']}").json(), plain.get(f"{SESSIONS}/{at_once}").json()]
    for one in stored:
        for own in ("uploaded_at", "filename"):
            one.pop(own, None)
    assert stored[0] == stored[1]


def test_a_refusal_is_told_by_job_and_upload(client: httpx.Client, settings: Settings) -> None:
    bad = session_bytes().replace(b'"table": {', b'"table": {"A9": [1.0],')
    job = client.post(SESSIONS, headers=LATER, content=bad).json()
    at_once = client.post(SESSIONS, content=bad).json()["problems"]
    told = client.get(f"/api/v1/jobs/{job['id']}").json()
    upload = client.get("/api/v1/uploads/j1").json()
    assert (told["state"], upload["stored"]) == ("failed", False)
    assert at_once == told["problems"] == upload["problems"] != []
    assert not list((settings.files / FOLDER).glob("*"))


def test_the_page_shows_card_job_and_problems(client: httpx.Client) -> None:
    pages = [client.post("/upload", files={"files": ("log.json", content)}).text for content in (
        session_bytes(), session_bytes().replace(b'"format"', b'"form"'))]  # fmt: skip
    assert ['href="/jobs/1"' in pages[0], 'href="/jobs/2"' in pages[1]] == [True, True]
    assert "Open the session" in client.get("/jobs/1/outcome").text
    assert "format" in client.get("/jobs/2").text
    assert "cannot be used" in client.get("/jobs/2/outcome").text


def test_what_still_waits_is_found_among_the_uploads(client: httpx.Client, waiting: None) -> None:
    assert 'href="/jobs/1"' in client.get("/uploads").text
    card = client.get("/jobs/1/outcome").text
    assert ("<progress" in card, "is received and being read" in card) == (True, True)
    told = client.get("/api/v1/uploads/j1").json()
    assert (told["stored"], told["job"], told["filename"]) == (False, "/api/v1/jobs/1", "a.json")
    cancelled = client.post("/jobs/1/cancel", data={"by": "K. Ito"}, follow_redirects=True).text
    assert "nothing was stored, and the file is gone" in cancelled


def test_what_still_waits_is_listed_apart_where_the_list_begins(client: httpx.Client, waiting: None) -> None:
    told, stored = client.get("/api/v1/uploads/j1").json(), client.post(SESSIONS, content=session_bytes(seed=2)).json()
    listed = client.get("/api/v1/uploads").json()
    assert (listed["under_way"], [one["id"] for one in listed["uploads"]]) == ([told], [stored["id"]])
    asked = ({"q": "A.J"}, {"q": "b.j"}, {"refused": True}, {"after": stored["id"]})
    narrowed = [client.get("/api/v1/uploads", params=one).json()["under_way"] for one in asked]
    assert narrowed == [[told], [], [], []]


def test_a_job_of_another_kind_is_no_upload(client: httpx.Client) -> None:
    assert client.post("/api/v1/jobs/report", json={"format": "xlsx"}).status_code == 202
    assert client.get("/api/v1/uploads/j1").status_code == 404


def test_what_it_replaces_must_be_there_before_it_is_acknowledged(client: httpx.Client) -> None:
    stated = {"supersedes": "none", "by": "K. Ito", "why": "wrong"}
    assert client.post(SESSIONS, headers=LATER, params=stated, **UPLOAD).status_code == 404


def test_a_table_of_ones_own_takes_its_mapping_along(client: httpx.Client) -> None:
    form = {"files": {"file": ("own.csv", OWN * 20)}, "data": {"mapping": '{"format": "imu-mapping/1", "columns": []}'}}
    job = client.post(SESSIONS, headers=LATER, **form).json()
    told = client.get(f"/api/v1/jobs/{job['id']}").json()
    assert (told["state"], told["problems"]) == ("failed", client.post(SESSIONS, **form).json()["problems"])
