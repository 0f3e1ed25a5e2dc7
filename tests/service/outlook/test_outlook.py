"""Due dates of units: from uploads to dates, across services, against their population."""

from datetime import UTC, datetime, timedelta

import httpx
import pytest

from service.fleet.changes import summarise_all
from service.outlook.reading import outlook_of
from service.outlook.records import UnitOutlook
from service.records.changes import record_service
from service.storage import Storage
from service.units.records import NewService
from tests.databases import one_engine
from tests.service.dated import upload_and_date
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def measure(storage: Storage, months: dict[int, float], unit: str = "BA-017", **changes: object) -> None:
    """Sessions of a unit by month of 2026, with how far A3's bias has moved, µg."""
    for month, moved in months.items():
        content = session_bytes(seed=month, month=month, a3_moved=moved, unit=unit, **changes)
        upload_and_date(storage, content, "a.json", NOW, outlook=month == max(months))


def outlook(storage: Storage, now: datetime, unit: str = "BA-017") -> UnitOutlook:
    """Outlook of a unit, at a time."""
    with storage.database.reading() as store:
        return outlook_of(store, unit, now)


@one_engine
def test_a_drift_brings_the_unit_back_before_its_tolerance(storage: Storage) -> None:
    measure(storage, {1: 0.0, 3: 7.0, 5: 14.0, 7: 21.0, 9: 28.0})
    found = outlook(storage, NOW)
    trend = next(t for t in found.trends if (t.sensor, t.parameter) == ("A3", "bias"))
    assert trend.rate_per_year == pytest.approx(42 * 9.80665e-6, abs=3 * trend.rate_sigma)
    assert (found.sensor, found.parameter) == ("A3", "bias")
    assert found.reach_90 is not None
    assert found.reach_50 is not None
    assert found.due is not None
    assert found.due < found.reach_50
    assert datetime(2026, 11, 1, tzinfo=UTC) < found.reach_50 < datetime(2027, 9, 1, tzinfo=UTC)
    assert found.risk_at_due == pytest.approx(0.05, abs=0.01)
    assert found.reason.startswith("The risk that it is out of tolerance reaches 5 % on ")
    assert found.reason.endswith("A3 bias contributes most.")


def test_a_stable_unit_comes_back_after_the_longest_interval_at_the_latest(storage: Storage) -> None:
    measure(storage, {1: 0.0})
    found = outlook(storage, NOW)
    assert found.due == datetime(2027, 1, 1, 9, tzinfo=UTC)
    assert (found.overdue, found.trends, found.risk_at_due) == (False, (), None)
    assert outlook(storage, NOW + timedelta(days=60)).overdue


@one_engine
def test_a_service_ends_every_trend_until_the_unit_is_measured_again(storage: Storage) -> None:
    measure(storage, {1: 0.0, 3: 15.0, 5: 30.0, 7: 45.0})
    record_service(storage, "BA-017", NewService("repair", datetime(2026, 8, 1, tzinfo=UTC)), NOW)
    waiting = outlook(storage, NOW)
    assert (waiting.reason, waiting.overdue) == ("Serviced on 1 Aug 2026: measure it again.", True)
    assert waiting.trends == ()
    measure(storage, {9: 45.0, 10: 45.0, 11: 45.0})
    after = outlook(storage, NOW)
    assert all(abs(t.level) < 0.5 * t.tolerance for t in after.trends)


@one_engine
def test_a_sudden_change_is_dated(storage: Storage) -> None:
    measure(storage, {1: 0.0, 2: 0.0, 3: 0.0, 4: 0.0, 5: 40.0, 6: 40.0, 7: 40.0, 8: 40.0})
    found = outlook(storage, NOW)
    stepped = {(t.sensor, t.parameter): [at.month for at in t.step_dates] for t in found.trends if t.step_dates}
    assert stepped == {("A3", "bias"): [5]}


@one_engine
def test_a_rate_is_set_against_the_type_s_other_units(storage: Storage) -> None:
    for number in range(4):
        measure(storage, {1: 0.0, 4: 0.0, 7: 0.0}, unit=f"BA-00{number}")
    measure(storage, {1: 0.0, 4: 25.0, 7: 50.0}, unit="BA-666")
    summarise_all(storage, NOW)
    serials = [f"BA-00{number}" for number in range(4)] + ["BA-666"]
    found = {serial: outlook(storage, NOW, serial) for serial in serials}
    z = {serial: next(t for t in o.trends if (t.sensor, t.parameter) == ("A3", "bias")) for serial, o in found.items()}
    assert max(z, key=lambda serial: abs(z[serial].population_z or 0)) == "BA-666"
    assert all(o.trends for o in found.values())


def test_the_outlook_over_http_with_the_risk_of_waiting(client: httpx.Client, storage: Storage) -> None:
    measure(storage, {1: 0.0, 3: 7.0, 5: 14.0, 7: 21.0, 9: 28.0})
    found = client.get("/api/v1/units/BA-017/outlook?until=2027-06-01").json()
    assert (found["sensor"], found["parameter"], found["until"]["at"]) == ("A3", "bias", "2027-06-01T00:00:00Z")
    assert 0.3 < found["until"]["risk"] <= 1
    assert found["due"] == client.get("/api/v1/units").json()["units"][0]["due"]
    assert client.get("/api/v1/units/none/outlook").status_code == 404


def test_another_longest_interval_holds_for_every_unit_of_the_type_at_once(
    client: httpx.Client, storage: Storage
) -> None:
    for unit in ("BA-1", "BA-2"):
        measure(storage, {1: 0.0}, unit)
    kind = client.get("/api/v1/unit-types").json()["unit_types"][0]
    body = {"tolerances": kind["tolerances"], "maximum_interval_days": 100}
    changed = client.put(f"/api/v1/unit-types/{kind['name']}", json=body).json()
    assert (changed["revision"], changed["maximum_interval_days"]) == (1, 100)
    assert {u["due"] for u in client.get("/api/v1/units").json()["units"]} == {"2026-04-11T09:00:00Z"}


def test_a_production_lot_is_recorded_and_taken_back(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes())
    lots = [client.put("/api/v1/units/BA-017/lot", json={"lot": lot}).json()["lot"] for lot in ("2024-07", None)]
    assert lots == ["2024-07", None]
    assert client.put("/api/v1/units/none/lot", json={"lot": "x"}).status_code == 404


@one_engine
def test_a_service_recorded_late_leaves_no_rate_that_two_sessions_made_up(storage: Storage) -> None:
    """The new reference was read some µg too high, and all that follow lie as much below it: an offset, no drift."""
    measure(storage, {1: 0.0, 3: 0.0, 5: 0.0, 7: 30.0, 9: 25.0, 10: 25.0})
    record_service(storage, "BA-017", NewService("adjustment", datetime(2026, 6, 15, tzinfo=UTC)), NOW)
    trend = next(t for t in outlook(storage, NOW).trends if (t.sensor, t.parameter) == ("A3", "bias"))
    rate, sigma = trend.rate_per_year / trend.tolerance, trend.rate_sigma / trend.tolerance
    assert abs(rate) < 0.1
    assert abs(rate) < sigma
