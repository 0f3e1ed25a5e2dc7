"""Services, notes, and a unit as found and as left, over HTTP."""

from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest

from service.outlook.changes import Sources, worked_out
from service.outlook.records import UnitOutlook
from service.records import follow
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.patience import LONG, until
from tests.service.made_sessions import session_bytes

UNIT = "/api/v1/units/BA-017"
AT_ONCE = 12


def upload(client: httpx.Client, **session: object) -> str:
    """Uploads a session and returns its id."""
    answer = client.post("/api/v1/sessions", content=session_bytes(**session))
    return str(answer.json()["id"])


@pytest.fixture
def measured(holding: Holding) -> httpx.Client:
    """A unit with its reference session."""
    return holding(session_bytes())


@pytest.mark.parametrize("kind", ["adjustment", "repair", "sensor-swap", "reference", "service"])
def test_every_kind_of_service_is_a_break(measured: httpx.Client, kind: str) -> None:
    body = {"kind": kind, "at": "2026-04-01T00:00:00Z", "by": "K. Ito", "sensor": "A3", "note": "why"}
    kept = measured.post(f"{UNIT}/services", json=body).json()
    assert {key: kept[key] for key in ("kind", "who", "sensor", "note")} == {
        "kind": kind,
        "who": "K. Ito",
        "sensor": "A3",
        "note": "why",
    }
    upload(measured, seed=2, month=5, a3_moved=300.0)
    assert measured.get(UNIT).json()["summary"]["is_reference"]


def test_one_kind_on_two_sensors_is_two_services(measured: httpx.Client) -> None:
    for sensor in ("A1", "A2", "A2"):
        body = {"kind": "sensor-swap", "at": "2026-04-01T00:00:00Z", "sensor": sensor}
        assert measured.post(f"{UNIT}/services", json=body).status_code == 201
    assert [s["sensor"] for s in measured.get(UNIT).json()["services"]] == ["A1", "A2"]


def test_a_sensor_that_the_unit_does_not_have_is_refused(measured: httpx.Client) -> None:
    answer = measured.post(f"{UNIT}/services", json={"kind": "repair", "sensor": "G1"})
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "sensor")


def test_a_note_is_kept_and_withdrawn_never_erased(measured: httpx.Client) -> None:
    kept = measured.post(f"{UNIT}/notes", json={"text": "dropped", "by": "K. Ito", "at": "2026-04-01T00:00:00Z"}).json()
    assert (kept["at"], kept["withdrawal"]) == ("2026-04-01T00:00:00Z", None)
    path = f"/api/v1/notes/{kept['id']}/withdraw"
    answers = [measured.post(path, json={"by": "M. Okafor", "why": f"reason {i}"}) for i in (1, 2)]
    assert [answer.status_code for answer in answers] == [200, 409]
    [note] = measured.get(f"{UNIT}/notes").json()["notes"]
    assert (note["text"], note["withdrawal"]["who"], note["withdrawal"]["why"]) == ("dropped", "M. Okafor", "reason 1")


def test_what_is_not_there_is_404(client: httpx.Client) -> None:
    who = {"by": "K. Ito", "why": "why"}
    assert client.post(f"{UNIT}/notes", json={"text": "x", "by": "y"}).status_code == 404
    assert client.get(f"{UNIT}/notes").status_code == 404
    assert client.get(f"{UNIT}/found-and-left").status_code == 404
    assert client.post("/api/v1/notes/1/withdraw", json=who).status_code == 404
    assert client.put("/api/v1/sessions/none/stage", json={"stage": None, "by": "y"}).status_code == 404


def test_as_found_and_as_left_are_judged_against_the_same_reference(measured: httpx.Client) -> None:
    found = upload(measured, seed=2, month=5, a3_moved=90.0, stage="as-found")
    measured.post(f"{UNIT}/services", json={"kind": "adjustment", "at": "2026-05-15T00:00:00Z"})
    left = upload(measured, seed=3, month=6, a3_moved=10.0)
    measured.put(f"/api/v1/sessions/{left}/stage", json={"stage": "as-left", "by": "K. Ito"}).raise_for_status()
    pair = measured.get(f"{UNIT}/found-and-left").json()
    assert (pair["found"]["id"], pair["left"]["id"]) == (found, left)
    bias = next(p for p in pair["parameters"] if (p["found"]["sensor"], p["found"]["parameter"]) == ("A3", "bias"))
    assert (bias["found"]["verdict"], bias["left"]["verdict"]) == ("fail", "pass")
    assert bias["found"]["deviation"] == pytest.approx(90 * 9.80665e-6, rel=0.1)
    assert bias["left"]["deviation"] == pytest.approx(10 * 9.80665e-6, abs=4 * 9.80665e-6)
    assert bias["found"]["reference"] == bias["left"]["reference"]


def test_found_without_left_waits_for_it(measured: httpx.Client) -> None:
    assert measured.get(f"{UNIT}/found-and-left").json()["found"] is None
    upload(measured, seed=2, month=5, stage="as-found")
    pair = measured.get(f"{UNIT}/found-and-left").json()
    assert pair["left"] is None
    assert {line["left"] for line in pair["parameters"]} == {None}


def test_a_stage_that_a_file_makes_up_is_refused(client: httpx.Client) -> None:
    answer = client.post("/api/v1/sessions", content=session_bytes(stage="as-new"))
    assert answer.status_code == 422
    assert answer.json()["problems"][0]["field"] == "stage"


def test_what_follows_from_many_changes_of_a_unit_at_once_is_worked_out_once_or_twice(
    measured: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = list[Sources]()

    def all_recorded() -> bool:
        return len(measured.get(UNIT).json()["services"]) == AT_ONCE

    def once_all_are_recorded(sources: Sources) -> UnitOutlook:
        until(all_recorded)
        made.append(sources)
        return worked_out(sources)

    monkeypatch.setattr(follow, "PATIENCE", LONG)
    monkeypatch.setattr(follow, "worked_out", once_all_are_recorded)

    def record(number: int) -> int:
        service = {"kind": "repair", "at": f"2026-04-{number + 1:02d}T10:00:00Z", "by": "K. Ito"}
        return measured.post(f"{UNIT}/services", json=service).status_code

    with ThreadPoolExecutor(AT_ONCE) as pool:
        assert set(pool.map(record, range(AT_ONCE))) == {201}
    assert 1 <= len(made) <= 3
