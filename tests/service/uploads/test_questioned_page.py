"""A questioned session is seen by those who can put it right, and put right by one button."""

import json
from collections.abc import Sequence
from datetime import UTC, datetime

import httpx

from service.sessions.doubt import Remedies
from service.sessions.states import RecordKind, StateChange
from service.sessions.states_store import States
from service.storage import Storage
from service.uploads.correct import remedies_of
from service.uploads.receive import upload
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def in_mv(unit: str = "BA-031") -> bytes:
    """A session whose readings are in mV, declared V."""
    document = json.loads(session_bytes(unit=unit))
    for sensor in document["sensors"]:
        for column in (sensor["name"], f"{sensor['name']}_se"):
            document["table"][column] = [1000 * value for value in document["table"][column]]
    return json.dumps(document).encode()


def test_a_questioned_session_waits_on_the_fleet_page_and_says_what_it_is(client: httpx.Client) -> None:
    id = client.post("/api/v1/sessions", content=in_mv()).json()["id"]
    assert f'<a href="/sessions/{id}">BA-031' in client.get("/").text
    page = client.get(f"/sessions/{id}").text
    assert "Questioned</h1>" in page
    assert "readings of A1–A6 × 0.001" in page
    assert "Undecided</h1>" not in page
    assert client.get(f"/api/v1/sessions/{id}").json()["said"] == "Questioned"
    assert "Undecided" not in client.get(f"/sessions/{id}/outcome").text


def test_one_button_stores_the_corrected_file_in_its_place(client: httpx.Client) -> None:
    id = client.post("/api/v1/sessions", content=in_mv()).json()["id"]
    answer = client.post(f"/sessions/{id}/correct", data={"by": "K. Ito"}, follow_redirects=True)
    assert "Reference set" in answer.text
    assert "Corrected: readings of A1–A6 × 0.001." in answer.text
    assert "Questioned, waiting" not in client.get("/").text
    assert "Superseded</h1>" in client.get(f"/sessions/{id}").text


def test_programs_have_it_corrected_too(client: httpx.Client) -> None:
    id = client.post("/api/v1/sessions", content=in_mv()).json()["id"]
    receipt = client.post(f"/api/v1/sessions/{id}/correct", json={"by": "K. Ito"}).json()
    assert (receipt["state"], receipt["is_reference"], receipt["unit"]) == ("accepted", True, "BA-031")
    assert client.post(f"/api/v1/sessions/{id}/correct", json={"by": "K. Ito"}).status_code == 409


def corrections(storage: Storage, id: str, life: Sequence[StateChange]) -> Remedies:
    """Corrections that would put a session right."""
    with storage.database.reading() as store:
        return remedies_of(store, storage.files, id, life)


def test_what_would_put_it_right_is_kept_as_its_file_tells_it(storage: Storage) -> None:
    id = upload(storage, in_mv(), "a.json", NOW).id
    with storage.database.reading() as store:
        life = States(store).of(RecordKind.SESSION, id)
    assert corrections(storage, id, life) == corrections(storage, id, ())
    for file in storage.files.folder.rglob("*"):
        if file.is_file():
            file.unlink()
    assert corrections(storage, id, life).correction == "readings of A1–A6 × 0.001"
