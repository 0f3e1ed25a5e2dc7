"""Units, history, known breaks, unit types and the fleet over HTTP."""

import io

import httpx
import polars as pl
import pytest

from tests.conftest import Holding
from tests.service.made_sessions import session_bytes

UNIT = "/api/v1/units/BA-017"
BIAS = {"parameter": "bias", "sensor": "A3"}


def upload(client: httpx.Client, **session: object) -> dict[str, object]:
    """Uploads a session and returns the answer."""
    answer: dict[str, object] = client.post("/api/v1/sessions", content=session_bytes(**session)).json()
    return answer


@pytest.fixture
def measured(holding: Holding) -> httpx.Client:
    """A unit with a reference, a good session, and one with A3 beyond its tolerance."""
    return holding(session_bytes(), session_bytes(seed=2, month=5), session_bytes(seed=3, month=7, a3_moved=90.0))


def test_a_unit_shows_condition_type_reference_and_sessions(measured: httpx.Client) -> None:
    unit = measured.get(UNIT).json()
    assert (unit["summary"]["verdict"], unit["summary"]["sessions"]) == ("fail", 3)
    assert (unit["summary"]["worst_sensor"], unit["summary"]["worst_parameter"]) == ("A3", "bias")
    assert unit["unit_type"]["tolerances"]["scale"] == 1e-4
    assert unit["reference_session"] == unit["sessions"][-1]["id"]


def test_history_has_a_band_a_tolerance_and_a_verdict_at_every_point(measured: httpx.Client) -> None:
    points = measured.get(f"{UNIT}/history", params=BIAS).json()["points"]
    assert [p["verdict"] for p in points] == ["undecidable", "pass", "fail"]
    assert all(p["lower"] < p["value"] < p["upper"] for p in points)
    assert len({p["reference"] for p in points}) == 1
    assert points[2]["value"] - points[0]["value"] == pytest.approx(90 * 9.80665e-6, rel=0.1)


def test_a_scale_tolerance_is_given_in_the_unit_of_the_scale(measured: httpx.Client) -> None:
    point = measured.get(f"{UNIT}/history", params={"parameter": "scale"}).json()["points"][0]
    assert point["tolerance"] == pytest.approx(1e-4 * point["reference"])


def test_history_is_cut_by_date(measured: httpx.Client) -> None:
    cut = {"since": "2026-05-01T00:00:00Z", "until": "2026-07-01T00:00:00Z"}
    points = measured.get(f"{UNIT}/history", params=BIAS | cut).json()["points"]
    assert [p["at"] for p in points] == ["2026-05-01T09:00:00Z"]


def test_a_bound_beyond_what_is_kept_cuts_nothing(measured: httpx.Client) -> None:
    cut = {"since": "0001-01-01T00:00:00+14:00", "until": "9999-12-31T23:59:59-12:00"}
    history = measured.get(f"{UNIT}/history")
    assert measured.get(f"{UNIT}/history", params=cut).json() == history.json()


def test_history_as_csv_and_parquet_holds_the_same(measured: httpx.Client) -> None:
    json = measured.get(f"{UNIT}/history").json()["points"]
    csv = pl.read_csv(measured.get(f"{UNIT}/history?format=csv").content)
    parquet = pl.read_parquet(io.BytesIO(measured.get(f"{UNIT}/history?format=parquet").content))
    assert csv["value"].to_list() == parquet["value"].to_list() == [p["value"] for p in json]
    assert csv["verdict"].to_list() == parquet["verdict"].to_list() == [p["verdict"] for p in json]
    assert parquet["axis_x"].to_list() == [p["axis"] and p["axis"][0] for p in json]


def test_history_comes_page_by_page(measured: httpx.Client) -> None:
    first = measured.get(f"{UNIT}/history", params={"limit": 50}).json()
    second = measured.get(f"{UNIT}/history", params={"limit": 50, "page": first["next_page"]}).json()
    points = first["points"] + second["points"]
    assert (len(points), second["next_page"]) == (72, None)
    assert len({(p["session"], p["sensor"], p["parameter"]) for p in points}) == 72


def test_tables_of_a_history_lead_to_the_next_one(measured: httpx.Client) -> None:
    first = measured.get(f"{UNIT}/history", params={"limit": 50, "format": "csv"})
    second = measured.get(first.links["next"]["url"])
    assert [len(pl.read_csv(table.content)) for table in (first, second)] == [50, 22]
    assert "next" not in second.links


def test_the_deviation_that_was_judged_stands_in_the_history(measured: httpx.Client) -> None:
    reference, _, moved = measured.get(f"{UNIT}/history", params=BIAS).json()["points"]
    assert (reference["is_reference"], reference["deviation"]) == (True, None)
    assert moved["deviation"] == pytest.approx(moved["value"] - moved["reference"])
    assert moved["expanded"] > moved["upper"] - moved["value"]


@pytest.mark.parametrize("path", ["", "/history", "/services"])
def test_an_unknown_unit_is_not_found(client: httpx.Client, path: str) -> None:
    call = client.post if path == "/services" else client.get
    body = {"json": {"kind": "repair"}} if path == "/services" else {}
    answer = call(f"/api/v1/units/none{path}", **body)
    assert (answer.status_code, answer.json()["detail"]) == (404, "There is no unit 'none'.")


def test_a_serial_number_may_hold_a_slash(client: httpx.Client) -> None:
    upload(client, unit="BA/17 №3")
    assert client.get("/api/v1/units/BA/17 №3").json()["summary"]["serial"] == "BA/17 №3"
    assert client.get("/api/v1/units/BA%2F17 №3/history").json()["unit"] == "BA/17 №3"


def test_after_a_service_the_next_session_is_the_new_reference(measured: httpx.Client) -> None:
    body = {"kind": "repair", "at": "2026-08-01T00:00:00", "note": "A3 replaced"}
    assert measured.post(f"{UNIT}/services", json=body).status_code == 201
    assert measured.get(UNIT).json()["reference_session"] is None
    first = upload(measured, seed=4, month=9, a3_moved=90.0)
    assert (first["verdict"], str(first["reason"])[:28]) == ("undecidable", "First session after a servic")
    assert upload(measured, seed=5, month=10, a3_moved=90.0)["verdict"] == "pass"


def test_a_late_session_is_judged_within_the_epoch_it_was_measured_in(measured: httpx.Client) -> None:
    measured.post(f"{UNIT}/services", json={"kind": "adjustment", "at": "2026-08-01T00:00:00Z"})
    assert upload(measured, seed=6, month=6)["verdict"] == "pass"
    assert measured.get(UNIT).json()["summary"]["verdict"] == "fail"  # July is still the latest


def test_the_same_service_twice_is_one(measured: httpx.Client) -> None:
    body = {"kind": "repair", "at": "2026-08-01T00:00:00Z"}
    ids = {measured.post(f"{UNIT}/services", json=body).json()["id"] for _ in range(2)}
    assert len(ids) == 1
    assert len(measured.get(UNIT).json()["services"]) == 1


def test_a_service_in_the_future_is_refused(measured: httpx.Client) -> None:
    answer = measured.post(f"{UNIT}/services", json={"kind": "repair", "at": "2190-01-01T00:00:00Z"})
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "at")


def test_other_tolerances_hold_from_the_next_session_on(measured: httpx.Client) -> None:
    name = measured.get(UNIT).json()["unit_type"]["name"]
    wider = {"scale": 1e-4, "bias": 2e-3, "quadratic": None, "axis": 1e-4}
    changed = measured.put(f"/api/v1/unit-types/{name}", json={"tolerances": wider})
    assert changed.json()["revision"] == 2
    assert measured.get(UNIT).json()["summary"]["verdict"] == "fail"
    found = upload(measured, seed=8, month=10, a3_moved=90.0)
    assert found["verdict"] == "pass"
    rules = {d["rule"] for d in measured.get(f"/api/v1/sessions/{found['id']}").json()["decisions"]}
    assert rules == {f"ILAC-G8-four-state/3 ({name} rev 2)"}


def test_the_same_tolerances_again_are_no_revision(measured: httpx.Client) -> None:
    kind = measured.get("/api/v1/unit-types").json()["unit_types"][0]
    same = {"tolerances": kind["tolerances"], "gyro_tolerances": kind["gyro_tolerances"]}
    assert measured.put(f"/api/v1/unit-types/{kind['name']}", json=same).json()["revision"] == 1


@pytest.mark.parametrize("bias", [0, -1e-3, "wide", 1e300])
def test_a_tolerance_that_means_nothing_is_refused(measured: httpx.Client, bias: object) -> None:
    body = {"tolerances": {"scale": 1e-4, "bias": bias, "quadratic": None, "axis": 1e-4}}
    answer = measured.put("/api/v1/unit-types/accelerometer × 6, V", json=body)
    assert answer.status_code == 422
    assert answer.json()["problems"][0]["field"] == "tolerances.bias"


def test_the_fleet_counts_units_by_verdict(measured: httpx.Client) -> None:
    upload(measured, unit="BA-018")
    fleet = measured.get("/api/v1/fleet").json()
    assert (fleet["units"], fleet["verdicts"]["fail"], fleet["verdicts"]["undecidable"]) == (2, 1, 1)


def test_units_are_listed_worst_first_and_found_by_text_and_verdict(measured: httpx.Client) -> None:
    upload(measured, unit="QX-1")
    names = [u["serial"] for u in measured.get("/api/v1/units").json()["units"]]
    assert names == ["BA-017", "QX-1"]
    for query in ({"q": "qx"}, {"verdict": "undecidable"}):
        assert [u["serial"] for u in measured.get("/api/v1/units", params=query).json()["units"]] == ["QX-1"]
    assert measured.get("/api/v1/units", params={"q": "%"}).json()["units"] == []


def test_the_fleet_report_comes_as_json_and_csv(measured: httpx.Client) -> None:
    listed = measured.get("/api/v1/fleet/report").json()["units"]
    table = pl.read_csv(measured.get("/api/v1/fleet/report?format=csv").content)
    assert table["serial"].to_list() == [u["serial"] for u in listed] == ["BA-017"]


def test_a_format_that_is_not_offered_says_what_is(client: httpx.Client) -> None:
    answer = client.get("/api/v1/fleet/report?format=odt")
    assert answer.status_code == 422
    offered = "Input should be 'json', 'csv', 'parquet', 'arrow', 'xlsx' or 'pdf'"
    assert answer.json()["problems"] == [{"field": "format", "row": None, "message": offered}]
