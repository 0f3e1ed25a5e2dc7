"""A mistyped serial number is asked about at once and is evidence of nothing; the next unit of a fleet is not asked."""

import json
from dataclasses import replace
from typing import Any

import httpx
import numpy as np
import pytest

from tests.builders import accelerometer_block, true_sensors
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes

API = "/api/v1/sessions"
WHY = {"by": "K. Ito", "why": "looked at the label"}
HTML = {"Accept": "text/html"}


def measured(serial: str, *, truth: int, seed: int = 1, month: int = 3, **changes: Any) -> bytes:
    """A session of the physical unit of a number, whatever serial number is written on it."""
    rng = np.random.default_rng(truth)
    sensors = [
        replace(one, scale=one.scale * (1 + 1e-3 * float(rng.standard_normal())))
        for one in true_sensors(3, bias=1e-3, tilt=1e-4, seed=truth)
    ]
    document = accelerometer_block(3, seed=seed + 1000 * truth, unit=serial, sensors=sensors, positions=8)
    for sensor in document["sensors"]:
        sensor["nominal_scale"] = 0.12
    own = {"started_at": f"2026-{month:02d}-01T09:00:00Z", "unit_type": "three"}
    return json.dumps(document | own | changes).encode()


def sent(client: httpx.Client, content: bytes) -> dict[str, Any]:
    """Answer to an upload."""
    answer = client.post(API, content=content)
    assert answer.status_code == 201, answer.text
    found: dict[str, Any] = answer.json()
    return found


def state_of(client: httpx.Client, id: str) -> str:
    state: str = client.get(f"{API}/{id}").json()["state"]
    return state


def members(client: httpx.Client, level: str, name: str) -> int:
    """Sessions that a group rests on."""
    found: int = client.get(f"/api/v1/{level}/{name}/diagnosis").json()["sessions"]
    return found


def renamed(content: bytes, **changes: Any) -> bytes:
    """The session with the same readings and other words beside them."""
    return json.dumps(json.loads(content) | changes).encode()


FIRST = measured("BA-101", truth=101)


@pytest.mark.parametrize("serial", ["BA-10l", "BA-1O1", "ba-101", "B\u0410-101", "QX-77"])
def test_readings_that_are_stored_under_another_serial_are_asked_about(client: httpx.Client, serial: str) -> None:
    first = sent(client, FIRST)
    copy = sent(client, renamed(FIRST, unit=serial, notes="again", started_at="2026-04-02T09:00:00Z"))
    assert (copy["unit"], copy["state"], copy["is_reference"]) == (serial, "questioned", False)
    assert f"stored already as session {first['id']} of BA-101" in copy["reason"]
    assert members(client, "unit-types", "three") == 1
    assert not client.get(f"/api/v1/units/{serial}/usable").json()["usable"]


@one_engine
def test_one_click_gives_a_copy_to_its_unit(client: httpx.Client) -> None:
    first = sent(client, FIRST)
    copy = sent(client, renamed(FIRST, unit="BA-10l"))
    assert "It is BA-101" in client.get(f"/sessions/{copy['id']}", headers=HTML).text
    done = client.post(f"{API}/{copy['id']}/correct", json={"by": "K. Ito"})
    assert (done.status_code, done.json()["id"], done.json()["unit"]) == (200, first["id"], "BA-101")
    shown = client.get(f"{API}/{copy['id']}").json()
    assert (shown["state"], shown["superseded_by"], state_of(client, first["id"])) == (
        "superseded",
        first["id"],
        "accepted",
    )


def test_readings_count_once_even_if_both_are_accepted(client: httpx.Client) -> None:
    sent(client, FIRST)
    copy = sent(client, renamed(FIRST, unit="QX-77"))
    assert client.post(f"{API}/{copy['id']}/accept", json=WHY).status_code == 200
    sent(client, measured("BA-102", truth=102))
    assert members(client, "unit-types", "three") == 2


@pytest.mark.parametrize("serial", ["BA-10l", "ba-101", "BA-I01", "\u0412\u0410-101", "BB-101", "BA101", "BA-1011"])
def test_a_new_serial_near_a_known_one_asks_before_it_is_a_unit(client: httpx.Client, serial: str) -> None:
    sent(client, FIRST)
    asked = sent(client, measured(serial, truth=101, seed=2, month=5))
    assert (asked["unit"], asked["state"]) == (serial, "questioned")
    assert "is this BA-101" in asked["reason"]
    assert members(client, "unit-types", "three") == 1


@one_engine
@pytest.mark.parametrize("way", ["it is that", "it is another"])
def test_one_click_says_which_unit_it_is(client: httpx.Client, way: str) -> None:
    sent(client, FIRST)
    asked = sent(client, measured("BA-10l", truth=101, seed=2, month=5))
    assert "It is BA-101" in client.get(f"/sessions/{asked['id']}", headers=HTML).text
    if way == "it is that":
        made = client.post(f"{API}/{asked['id']}/correct", json={"by": "K. Ito"}).json()
        assert (made["unit"], made["state"]) == ("BA-101", "accepted")
        assert state_of(client, asked["id"]) == "superseded"
    else:
        assert client.post(f"{API}/{asked['id']}/accept", json=WHY).json()["state"] == "accepted"
        after = sent(client, measured("BA-10l", truth=101, seed=3, month=6))
        assert (after["unit"], after["state"]) == ("BA-10l", "accepted")


@pytest.mark.slow
@one_engine
def test_nobody_of_a_numbered_fleet_is_asked_and_a_mistyped_number_is(client: httpx.Client) -> None:
    numbers = [101 + k * 7 % 30 for k in range(30)]
    answers = [sent(client, measured(f"BA-{n}", truth=n)) for n in numbers]
    assert [one["unit"] for one in answers if one["state"] != "accepted"] == []
    asked = sent(client, measured("BA-145", truth=115, seed=2, month=5))
    assert (asked["state"], "is this BA-115" in asked["reason"]) == ("questioned", True)
    assert sent(client, measured("BA-135", truth=135))["state"] == "accepted"


@one_engine
def test_a_corrected_file_of_the_right_unit_is_not_asked(client: httpx.Client) -> None:
    wrong = sent(client, renamed(FIRST, unit="BA-10l"))
    assert wrong["state"] == "accepted"
    right = client.post(API, params={"supersedes": wrong["id"], **WHY}, content=FIRST).json()
    assert (right["unit"], right["state"]) == ("BA-101", "accepted")


@one_engine
@pytest.mark.parametrize("serial", ["", " ", ".", "..", "/", "BA/../x", "x" * 201, "BA\u202e-1", "B\u200bA", "BA\x07"])
@pytest.mark.parametrize("field", ["unit", "unit_type"])
def test_a_name_that_no_address_can_hold_is_refused(client: httpx.Client, field: str, serial: str) -> None:
    if field == "unit_type" and not serial.strip():
        return
    refused = client.post(API, content=session_bytes(**{field: serial}))
    assert (refused.status_code, refused.headers["content-type"]) == (422, "application/problem+json")
    assert [one["field"] for one in refused.json()["problems"]] == [field]


@pytest.mark.parametrize("written", [" BA-101 ", "BA-101\u2003", "\tBA-101"])
def test_space_around_a_serial_is_none_of_it(client: httpx.Client, written: str) -> None:
    sent(client, FIRST)
    again = sent(client, measured(written, truth=101, seed=2, month=5))
    assert (again["unit"], again["state"]) == ("BA-101", "accepted")


def test_composed_and_decomposed_letters_are_one_serial(client: httpx.Client) -> None:
    sent(client, measured("Ger\u00e4t 7", truth=7))
    again = sent(client, measured("Gera\u0308t  7", truth=7, seed=2, month=5))
    assert (again["unit"], again["state"]) == ("Ger\u00e4t 7", "accepted")
