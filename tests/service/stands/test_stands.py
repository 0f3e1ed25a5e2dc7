"""A stand whose seat has turned is found over the units that are measured on it."""

import json
from datetime import UTC, datetime

import httpx
import numpy as np
from scipy.spatial.transform import Rotation

from service.flags.changes import resolve_flag
from service.flags.records import Matter
from service.flags.store import FlagQuery, Flags
from service.records.flagging.lasting import flag_shifted_stands
from service.storage import Storage
from service.uploads.receive import upload
from tests.builders import ARCSEC, TrueSensor, accelerometer_block, true_sensors
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.databases import one_engine

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


@one_engine
def test_a_shifted_stand_raises_one_flag_on_the_units_that_it_measured_last(storage: Storage) -> None:
    for number in range(4):
        measure(storage, number, "S1" if number == 3 else "S2")

    def flagged() -> list[tuple[str, str, str]]:
        with storage.database.reading() as store:
            found = [flag for flag in Flags(store).page(FlagQuery()) if flag.matter is Matter.SHIFTED]
        return sorted((flag.unit, flag.place, flag.state.value) for flag in found)

    flag_shifted_stands(storage, NOW)
    assert flagged() == [(f"BA-{number}", "S2", "raised") for number in range(3)]
    with storage.database.reading() as store:
        first = next(flag.id for flag in Flags(store).page(FlagQuery("BA-0")) if flag.matter is Matter.SHIFTED)
    resolve_flag(storage, first, "K. Ito", "seat of S2 mended", NOW)
    flag_shifted_stands(storage, NOW)
    assert flagged()[0] == ("BA-0", "S2", "resolved")
    assert len(flagged()) == 3


def test_an_open_flag_whose_shift_is_dated_anew_stays_one_flag(storage: Storage) -> None:
    """Raised when the shift was dated to before June; by what was measured since it is dated to July."""
    for number in range(4):
        measure(storage, number)
    for day in (datetime(2026, 6, 15, tzinfo=UTC), NOW, NOW):
        flag_shifted_stands(storage, day)
    with storage.database.reading() as store:
        found = [flag for flag in Flags(store).page(FlagQuery("BA-0")) if flag.matter is Matter.SHIFTED]
    assert [flag.state.value for flag in found] == ["raised"]
