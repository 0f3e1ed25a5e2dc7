"""The temperature laws of a type: learned when an engineer says so, and in force from the next session on."""

import json

import pytest

from estimator.groups import type_laws
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes, session_id

PER_DEGREE = 6.0
"""µg by which the bias of A3 follows the room, in every unit."""
ROOMS = (20, 34, 22, 12, 30, 16)
OTHERS = ("BA-101", "BA-102")
YOUNG = "BA-900"
TYPE = "/api/v1/unit-types/RA-4"
LAWS = f"{TYPE}/temperature-laws"


def at(unit: str, celsius: float, month: int) -> bytes:
    """A session of a unit of the type at a temperature."""
    content = session_bytes(unit=unit, seed=month, month=month, m=4, a3_moved=PER_DEGREE * (celsius - 20))
    document = json.loads(content) | {"unit_type": "RA-4"}
    document["table"]["temperature_c"] = [celsius] * len(document["table"]["A1"])
    return json.dumps(document).encode()


KNOWN = tuple(at(unit, celsius, month) for unit in OTHERS for month, celsius in enumerate(ROOMS, 1))
FIRST = tuple(at(YOUNG, celsius, month) for month, celsius in enumerate((20, 30, 14, 25), 1))
BEFORE, AFTER = at(YOUNG, 33, 5), at(YOUNG, 34, 6)


def wanted(in_force: bool) -> dict[str, object]:
    return {"in_force": in_force, "by": "K. Ito", "why": "units over a year"}


def test_a_unit_with_few_sessions_is_judged_by_the_laws_of_its_type(
    holding: Holding, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two units are enough here, so that the test is quick."""
    monkeypatch.setattr(type_laws, "FEWEST_UNITS", 2)
    monkeypatch.setattr(type_laws, "FEWEST_SENSORS", 8)
    client = holding(*KNOWN, *FIRST, BEFORE)
    assert client.get(TYPE).json()["temperature_laws"] == []
    assert client.put(LAWS, json=wanted(False)).status_code == 409
    found = client.put(LAWS, json=wanted(True)).raise_for_status().json()
    assert found["revision"] == 2
    (bias,) = [law for law in found["temperature_laws"] if law["parameter"] == "bias"]
    assert (bias["units"], bias["sensors"]) == (2, 8)
    client.post("/api/v1/sessions", content=AFTER).raise_for_status()
    before, after = (client.get(f"/api/v1/sessions/{session_id(one)}").json() for one in (BEFORE, AFTER))
    assert (before["verdict"], after["verdict"]) == ("fail", "pass")
    (own,) = [
        d["temperature_correction"] for d in after["decisions"] if (d["sensor"], d["parameter"]) == ("A3", "bias")
    ]
    assert (own["sessions"], own["units"]) == (5, 2)
    assert own["measured"] == pytest.approx(own["worth"], rel=0.2)
    assert "by the law of 5 sessions and 2 units of its type." in after["reason"]
    page = client.get("/unit-types/RA-4").text
    assert "set by K. Ito" in page
    assert '<td data-label="Temperature laws">2 units</td>' in page
    without = client.put(LAWS, json=wanted(False)).json()
    assert (without["revision"], without["temperature_laws"]) == (3, [])
    assert without["tolerances"] == found["tolerances"]


def test_few_units_tell_of_no_law(holding: Holding) -> None:
    answer = holding(*FIRST).put(LAWS, json=wanted(True))
    assert answer.status_code == 409
    assert "Too few units: five with ten sensors in all" in answer.json()["detail"]
