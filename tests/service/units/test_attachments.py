"""Files and remarks of units and sessions: kept by their hash, given out as files to save, taken back for a reason."""

from pathlib import Path

import httpx
import pytest

from service.app import create_app
from service.storage import Files
from service.storage.backup import restore, write_backup
from tests.conftest import Holding, SettingsHolding
from tests.databases import Databases, one_engine
from tests.service.made_sessions import session_bytes, session_id
from tests.service.people.staff import NOW
from tests.serving import http_client, limited_client

ATTACHMENTS = "/api/v1/attachments"
SESSION = session_bytes()
ID = session_id(SESSION)
PAGE = b"<script>alert(1)</script>"
TO_SESSION = {"session": ID, "by": "K. Ito", "text": "the fixture"}
TO_UNIT = {"unit": "BA-017", "by": "K. Ito"}


@pytest.fixture
def measured(holding: Holding) -> httpx.Client:
    """A unit with one session."""
    return holding(SESSION)


def attach(client: httpx.Client, data: dict[str, str], name: str = "a.html", content: bytes = PAGE) -> httpx.Response:
    return client.post(ATTACHMENTS, data=data, files={"file": (name, content, "text/html")})


def listed(client: httpx.Client, of: str) -> list[dict[str, object]]:
    found: list[dict[str, object]] = client.get(f"/api/v1/{of}/attachments").json()["attachments"]
    return found


def test_a_session_s_file_is_its_unit_s_too_and_the_other_way_it_is_not(measured: httpx.Client) -> None:
    first, second = attach(measured, TO_SESSION).json(), attach(measured, TO_UNIT, content=b"other").json()
    assert [a["id"] for a in listed(measured, "units/BA-017")] == [first["id"], second["id"]]
    assert [a["id"] for a in listed(measured, f"sessions/{ID}")] == [first["id"]]
    assert (first["size"], first["who"], first["text"], first["unit"]) == (25, "K. Ito", "the fixture", "BA-017")
    assert [line["action"] for line in measured.get("/api/v1/audit").json()["lines"]][:2] == ["attach", "attach"]


def test_it_is_given_out_as_it_was_and_never_shown(measured: httpx.Client) -> None:
    id = attach(measured, TO_UNIT, "../вид; x.html").json()["id"]
    answer = measured.get(f"{ATTACHMENTS}/{id}/file")
    assert answer.content == PAGE
    assert answer.headers["content-type"] == "application/octet-stream"
    assert answer.headers["x-content-type-options"] == "nosniff"
    named = "attachment; filename*=UTF-8''%D0%B2%D0%B8%D0%B4%3B%20x.html"
    assert answer.headers["content-disposition"] == named


def test_the_same_content_is_there_once_until_it_is_withdrawn(measured: httpx.Client) -> None:
    ids = [attach(measured, data).json()["id"] for data in (TO_UNIT, TO_UNIT, TO_SESSION)]
    assert ids[0] == ids[1] != ids[2]
    said = {"by": "K. Ito", "why": "the wrong unit"}
    gone = [measured.post(f"{ATTACHMENTS}/{ids[0]}/withdraw", json=said).status_code for _ in range(2)]
    assert gone == [200, 409]
    assert measured.get(f"{ATTACHMENTS}/{ids[0]}/file").status_code == 404
    assert "the wrong unit" in measured.get("/units/BA-017").text
    assert attach(measured, TO_UNIT).json()["id"] not in ids


@one_engine
@pytest.mark.parametrize(
    ("data", "status"),
    [
        (TO_UNIT | {"unit": "nobody"}, 404),
        (TO_UNIT | {"by": " "}, 422),
        ({"by": "K. Ito"}, 422),
        (TO_UNIT | TO_SESSION, 422),
        (TO_UNIT | {"text": "a\x00"}, 422),
        (TO_UNIT | {"text": 2001 * "a"}, 422),
    ],
)
def test_what_cannot_be_kept_is_refused(measured: httpx.Client, data: dict[str, str], status: int) -> None:
    assert attach(measured, data).status_code == status
    assert listed(measured, "units/BA-017") == []


@one_engine
def test_an_empty_and_a_large_file_are_refused(settings_holding: SettingsHolding) -> None:
    with limited_client(settings_holding(SESSION), attached=400_000) as client:
        sizes = (0, 400_000, 400_001)
        assert [attach(client, TO_UNIT, content=size * b"a").status_code for size in sizes] == [422, 201, 413]


def test_a_backup_brings_it_back(settings_holding: SettingsHolding, databases: Databases, tmp_path: Path) -> None:
    settings, url = settings_holding(SESSION), databases.empty()
    with http_client(create_app(settings)) as client:
        id = attach(client, TO_SESSION).json()["id"]
    write_backup(settings.database, Files(settings.files), tmp_path / "all", NOW)
    restore(tmp_path / "all", url, tmp_path / "new" / "files", NOW)
    moved = settings.model_copy(update={"database_url": url, "data_folder": tmp_path / "new"})
    with http_client(create_app(moved)) as client:
        assert client.get(f"{ATTACHMENTS}/{id}/file").content == PAGE


def test_a_remark_on_a_session_is_one_on_its_unit_and_is_taken_back(measured: httpx.Client) -> None:
    notes = f"/api/v1/sessions/{ID}/notes"
    note = measured.post(notes, json={"text": "the room was warm", "by": "K. Ito"}).json()
    assert note["session"] == ID
    assert [n["id"] for n in measured.get("/api/v1/units/BA-017/notes").json()["notes"]] == [note["id"]]
    measured.post(f"/api/v1/notes/{note['id']}/withdraw", json={"by": "K. Ito", "why": "another day"})
    assert measured.get(notes).json()["notes"][0]["withdrawal"]["why"] == "another day"
    measured.post("/api/v1/units/BA-017/notes", json={"text": "of the unit", "by": "K. Ito"})
    assert len(measured.get(notes).json()["notes"]) == 1


def test_both_are_written_on_the_pages(measured: httpx.Client) -> None:
    said = {"by": "K. Ito", "text": "the room was warm"}
    assert measured.post(f"/sessions/{ID}/notes", data=said).headers["location"] == f"/sessions/{ID}#remarks"
    sent = measured.post("/attachments", data=TO_SESSION, files={"file": ("<b>.png", b"png")})
    assert (sent.status_code, sent.headers["location"]) == (303, f"/sessions/{ID}#remarks")
    for page in (f"/sessions/{ID}", "/units/BA-017"):
        text = measured.get(page).text
        assert "the room was warm" in text
        assert "&lt;b&gt;.png" in text
        assert "<b>.png" not in text
