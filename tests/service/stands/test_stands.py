"""A stand whose seat has turned is found over the units that are measured on it."""

import json
from datetime import UTC, datetime

import httpx
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from service.flags.changes import resolve_flag
from service.flags.records import Concern, Flag, FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.models.records import Scope
from service.records.changes import withdraw_session
from service.records.flagging.acts import Occasion, raise_flag
from service.records.flagging.stands import OF_STAND, flag_shifted_stands
from service.sessions.records import SessionQuery
from service.sessions.store import Sessions
from service.storage import Storage
from service.units.store import Units
from service.uploads.receive import upload
from tests.builders import ARCSEC, TrueSensor, accelerometer_block, true_sensors
from tests.conftest import Filled
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.databases import one_engine
from tests.service.made_records import step, way

NOW = datetime(2026, 10, 1, tzinfo=UTC)
TURN = Rotation.from_rotvec(np.array([5.0, -8.0, 12.0]) * ARCSEC)


def seated(turned: bool) -> list[TrueSensor]:
    """Six sensors, turned as a block or not."""
    sensors = true_sensors(6, bias=1e-3, quadratic=1e-6, tilt=1e-4)
    if not turned:
        return sensors
    axes = TURN.apply(np.array([s.axis for s in sensors]))
    return [
        TrueSensor(s.name, tuple(axis), s.scale, s.bias, s.quadratic) for s, axis in zip(sensors, axes, strict=True)
    ]


def measured_on(stand: str, unit: str, month: int, seed: int) -> bytes:
    """A session of 2026; the seat of S2 turned in June."""
    document = accelerometer_block(sensors=seated(stand == "S2" and month > 6), unit=unit, seed=seed, positions=24)
    document["stand"]["id"] = stand
    return json.dumps(document | {"started_at": f"2026-{month:02d}-01T09:00:00Z"}).encode()


def measure(storage: Storage, number: int, last: str = "S2") -> None:
    """Five sessions of a unit on the two stands, the last on one of them."""
    for month, stand in ((1, "S1"), (3, "S2"), (5, "S1"), (7, "S2"), (9, last)):
        upload(storage, measured_on(stand, f"BA-{number}", month, seed=10 * number + month), "a.json", NOW)


@one_engine
def test_a_turned_stand_is_shown_and_its_units_pass(client: httpx.Client, storage: Storage) -> None:
    for number in range(4):
        measure(storage, number)
    found = {s["stand"]: s for s in client.get("/api/v1/stands").json()["stands"]}
    assert {stand: s["has_shifted"] for stand, s in found.items()} == {"S1": False, "S2": True}
    axes = next(e for e in found["S2"]["evidence"] if e["quantity"] == "axes")
    assert axes["since"] == "2026-07-01T09:00:00Z"
    assert abs(axes["size"] / ARCSEC - 15.26) < 4 * axes["sigma"] / ARCSEC
    assert [(s["since"], s["until"]) for s in found["S2"]["shifts"]] == [("2026-07-01T09:00:00Z", None)]
    assert found["S1"]["shifts"] == []
    tau = {own["quantity"]: own["tau"] for own in found["S1"]["seating"]}
    assert tau["axes"] / ARCSEC < 1
    assert {u["verdict"] for u in client.get("/api/v1/units").json()["units"]} == {"pass"}
    latest = client.get("/api/v1/units/BA-1").json()["sessions"][0]["id"]
    page = client.get(f"/sessions/{latest}", headers={"Accept": "text/html"}).text
    assert "The whole block turned by 15" in page
    assert "it was mounted differently, or the stand has turned" in page


def measure_all(storage: Storage) -> None:
    for number in range(4):
        measure(storage, number, "S1" if number == 3 else "S2")


@pytest.fixture
def shifted(filled: Filled) -> Storage:
    """Four units on two stands, of which S2 has turned in June; three were measured on it last."""
    return filled(measure_all)


def flagged(storage: Storage) -> list[Flag]:
    with storage.database.reading() as store:
        return list(Flags(store).page(FlagQuery(matter=Matter.SHIFTED)))


@one_engine
def test_a_shifted_stand_has_one_flag_that_names_the_units_it_measured_last(shifted: Storage) -> None:
    for _ in range(2):
        flag_shifted_stands(shifted, NOW)
    [flag] = flagged(shifted)
    assert (flag.scope, flag.subject, flag.place, flag.state) == (Scope.STAND, "S2", "S2", FlagState.RAISED)
    assert flag.summary.endswith("Seen with BA-0, BA-1, BA-2.")
    with shifted.database.reading() as store:
        assert Flags(store).page(FlagQuery("BA-0")) == ()
    resolve_flag(shifted, flag.id, "K. Ito", "seat of S2 mended", NOW)
    flag_shifted_stands(shifted, NOW)
    assert [flag.state for flag in flagged(shifted)] == [FlagState.RESOLVED]


@one_engine
def test_flags_that_every_unit_had_of_its_own_become_the_stand_s_one(shifted: Storage) -> None:
    with shifted.database.writing() as store:
        for number in range(3):
            concern = Concern(Matter.SHIFTED, "S2", 1, "It turns every block.")
            raise_flag(store, Occasion(Units(store).key(f"BA-{number}"), None, NOW), concern)
    flag_shifted_stands(shifted, NOW)
    states = [(flag.scope, flag.state) for flag in flagged(shifted)]
    assert states == [(Scope.STAND, FlagState.RAISED), *[(Scope.UNIT, FlagState.RESOLVED)] * 3]
    assert flagged(shifted)[1].changes[-1].text == OF_STAND


@pytest.mark.slow
def test_an_open_flag_whose_shift_is_dated_anew_stays_one_flag_and_closes_with_it(storage: Storage) -> None:
    """Raised when the shift was dated to before June; by what was measured since it is dated to July."""
    for number in range(4):
        measure(storage, number)
    for day in (datetime(2026, 6, 15, tzinfo=UTC), NOW, NOW):
        flag_shifted_stands(storage, day)
    assert [flag.state for flag in flagged(storage)] == [FlagState.RAISED]
    with storage.database.reading() as store:
        gone = [(s.unit, s.id) for s in Sessions(store).wanted(SessionQuery(stand="S2")) if s.started_at.month > 6]
    for _, id in gone:
        withdraw_session(storage, way(storage), id, step())
    flag_shifted_stands(storage, NOW)
    [flag] = flagged(storage)
    assert (flag.state, flag.changes[-1].text) == (
        FlagState.RESOLVED, "The units measured on S2 no longer show a shift.",
    )  # fmt: skip
