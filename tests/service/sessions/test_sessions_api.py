"""Sessions over HTTP: uploaded once, judged, read back unchanged; or refused with every fault."""

import json
from datetime import UTC, datetime
from hashlib import sha256

import httpx

from estimator import calibrate
from estimator.reading import read_session
from service.settings import Settings
from service.storage import Files, Storage
from service.uploads.receive import upload
from tests.builders import accelerometer_block
from tests.conftest import Holding
from tests.service.made_sessions import FAILED, session_bytes, session_id

SESSIONS = "/api/v1/sessions"


def post(client: httpx.Client, content: bytes) -> httpx.Response:
    """Uploads a session as the body."""
    return client.post(SESSIONS, content=content, headers={"Content-Type": "application/json"})


def test_an_upload_is_answered_with_id_unit_verdict_and_url(client: httpx.Client) -> None:
    content = session_bytes()
    answer = post(client, content)
    assert answer.status_code == 201
    assert answer.json()["id"] == sha256(content).hexdigest()[:20]
    assert (answer.json()["unit"], answer.json()["verdict"]) == ("BA-017", "undecidable")
    assert answer.json()["url"] == answer.headers["location"]
    assert client.get(answer.json()["url"]).json()["is_reference"] is True


def test_the_same_bytes_again_are_stored_once(client: httpx.Client) -> None:
    first = post(client, session_bytes())
    again = client.post(SESSIONS, files={"file": ("another name.json", session_bytes())})
    assert (first.status_code, again.status_code) == (201, 200)
    assert first.json()["id"] == again.json()["id"]
    assert len(client.get(SESSIONS).json()["sessions"]) == 1


def test_the_file_comes_back_unchanged(client: httpx.Client) -> None:
    content = b"\n  " + session_bytes() + b"\n\n"
    id = client.post(SESSIONS, files={"file": ("BA-017.json", content)}).json()["id"]
    assert client.get(f"{SESSIONS}/{id}/file").content == content
    assert client.get(f"{SESSIONS}/{id}").json()["filename"] == "BA-017.json"


def test_the_stored_calibration_is_the_one_that_the_library_computes(client: httpx.Client) -> None:
    content = session_bytes()
    id = post(client, content).json()["id"]
    expected = json.loads(json.dumps(calibrate(read_session(content)).to_dict()))
    assert client.get(f"{SESSIONS}/{id}/calibration").json() == expected


def test_a_moved_bias_fails_and_the_reason_names_it(holding: Holding) -> None:
    found = post(holding(session_bytes()), session_bytes(seed=2, month=9, a3_moved=90.0)).json()
    assert found["verdict"] == "fail"
    assert found["reason"].startswith("A3 bias changed by +9")
    assert "µg), beyond the tolerance of ±50 µg. Nobody has entered tolerances for" in found["reason"]


def test_every_decision_says_what_it_rests_on(holding: Holding) -> None:
    later = session_bytes(seed=2, month=5)
    decisions = holding(session_bytes(), later).get(f"{SESSIONS}/{session_id(later)}").json()["decisions"]
    assert len(decisions) == 24
    assert {d["verdict"] for d in decisions} == {"pass"}
    assert all(abs(d["expanded"] - 2 * d["uncertainty"]) < 1e-12 for d in decisions)
    assert {d["rule"] for d in decisions} == {"ILAC-G8-four-state/3 (accelerometer × 6, V rev 1)"}


def test_three_faults_are_reported_with_their_rows(client: httpx.Client) -> None:
    document = accelerometer_block()
    document["table"]["A2"][4] = "n/a"
    document["table"]["A5_se"][6] = -1.0
    document["table"]["time_s"][9] = 0.0
    answer = post(client, json.dumps(document).encode())
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    places = {(p["field"].rpartition(".")[2], p["row"]) for p in answer.json()["problems"]}
    assert {("A2", 5), ("A5_se", 7), ("time_s", 10)} <= places


def test_a_refused_upload_leaves_no_session(client: httpx.Client) -> None:
    assert post(client, b'{"format": "imu-session/2"}').status_code == 422
    assert client.get(SESSIONS).json()["sessions"] == []
    assert client.get("/api/v1/units").json()["units"] == []


def test_a_form_without_a_file_is_told_so(client: httpx.Client) -> None:
    answer = client.post(SESSIONS, files={"fiel": ("a.json", session_bytes())})
    assert answer.status_code == 422
    assert answer.json()["problems"][0]["field"] == "file"


def test_a_programme_that_does_not_calibrate_is_refused(client: httpx.Client) -> None:
    answer = post(client, session_bytes(programme="in-service"))
    assert answer.status_code == 422
    assert answer.json()["problems"]


def test_names_that_no_database_keeps_are_refused(client: httpx.Client) -> None:
    answer = post(client, session_bytes(unit="BA\x00", unit_type="x" * 300))
    assert answer.status_code == 422
    assert {p["field"] for p in answer.json()["problems"]} >= {"unit"}


def test_a_session_from_the_future_is_refused(client: httpx.Client) -> None:
    answer = post(client, session_bytes(started_at="2150-01-01T00:00:00Z"))
    assert answer.json()["problems"][0]["field"] == "started_at"


def test_sessions_are_listed_page_by_page_newest_first(client: httpx.Client, storage: Storage) -> None:
    for month in (3, 5, 4):
        upload(storage, session_bytes(seed=month, month=month), "a.json", datetime(2026, 11, 21, tzinfo=UTC))
    first = client.get(SESSIONS, params={"limit": 2, "unit": "BA-017"}).json()
    rest = client.get(SESSIONS, params={"limit": 2, "page": first["next_page"]}).json()
    months = [s["started_at"][5:7] for s in first["sessions"] + rest["sessions"]]
    assert (months, rest["next_page"]) == (["05", "04", "03"], None)


def test_a_stored_file_that_was_changed_is_never_given_out_and_the_same_upload_puts_it_back(
    client: httpx.Client, settings: Settings
) -> None:
    content = session_bytes()
    file = f"{SESSIONS}/{post(client, content).json()['id']}/file"
    Files(settings.files).path(sha256(content).hexdigest()).write_bytes(b"changed")
    answer = client.get(file)
    assert (answer.status_code, answer.headers["content-type"]) == (500, "application/problem+json")
    assert "not what was uploaded" in answer.json()["detail"]
    assert post(client, content).status_code == 200
    assert client.get(file).content == content
    assert 'imu_health_file_faults_total{fault="damaged"} 1.0' in client.get("/metrics").text
    assert 'imu_health_file_faults_total{fault="put back"} 1.0' in client.get("/metrics").text


def test_a_list_of_sessions_is_narrowed_and_ordered(flagged: httpx.Client) -> None:
    ids = [session_id(content) for content in FAILED]

    def listed(**asked: str) -> list[str]:
        found = flagged.get("/api/v1/sessions", params=asked).raise_for_status().json()["sessions"]
        return [session["id"] for session in found]

    assert listed(backwards="true") == ids
    assert listed(order="verdict", limit="1") == listed(verdict="fail") == ids[1:]
    assert listed(since="2026-01-02T00:00:00Z") == ids[1:]
    assert listed(until="2026-01-02T00:00:00Z") == ids[:1]
    assert listed(state="withdrawn") == listed(stand="none") == listed(unit_type="none") == listed(unit="none") == []
    assert listed(page="2", limit="1") == ids[:1]
