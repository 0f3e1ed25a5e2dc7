"""Numbers that no instrument has are refused with their place and bounds, and harm nobody's next upload."""

import json
from typing import Any

import httpx
import pytest

from benchmarks.fuzz.extremes import Case, cases, programmes
from tests.builders import accelerometer_block
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes

EVERY = 61
"""One case of so many: a prime, so that every number meets other places."""


def sent(client: httpx.Client, **changes: Any) -> httpx.Response:
    """An upload of a session in which something is another number."""
    return client.post("/api/v1/sessions", content=json.dumps(accelerometer_block(3, positions=4) | changes))


def problem_of(answer: httpx.Response) -> tuple[str, int | None, str]:
    """Field, row and message of the only problem of a refusal."""
    assert answer.status_code == 422, answer.text
    (found,) = answer.json()["problems"]
    return found["field"], found["row"], found["message"]


def test_a_tiny_scale_factor_is_refused_and_the_next_upload_is_taken(client: httpx.Client) -> None:
    sensors = accelerometer_block(3)["sensors"]
    field, _, message = problem_of(sent(client, sensors=[sensors[0] | {"nominal_scale": 1e-320}, *sensors[1:]]))
    assert field == "sensors[1].nominal_scale"
    assert "from 1e-12 to 1e+18" in message
    assert client.post("/api/v1/sessions", content=session_bytes()).status_code == 201


def test_a_tiny_error_of_the_stand_is_refused(client: httpx.Client) -> None:
    stand = accelerometer_block(3)["stand"]
    field, _, message = problem_of(sent(client, stand=stand | {"sigma_arcsec": {"alpha": 1e-300}}))
    assert field == "stand.sigma_arcsec.alpha"
    assert "must be 0 or at least 1e-06 in size; write 0 for none" in message


@one_engine
def test_a_tiny_reading_is_refused_by_its_row(client: httpx.Client) -> None:
    table = accelerometer_block(3, positions=4)["table"]
    table["A2"][2] = 5e-324
    assert problem_of(sent(client, table=table))[:2] == ("A2", 3)


@one_engine
def test_an_error_of_0_is_taken(client: httpx.Client) -> None:
    stand = accelerometer_block(3)["stand"]
    assert sent(client, stand=stand | {"sigma_arcsec": {"alpha": 0.0}}).status_code == 201


@pytest.mark.parametrize("number", ["1e18", "-1e18"])
@pytest.mark.parametrize("programme", ["arbitrary-orientations", "raw log"])
@one_engine
def test_a_channel_at_one_huge_value_did_not_answer_to_the_turns(
    client: httpx.Client, programme: str, number: str
) -> None:
    """The mean of equal numbers differs from them by rounding, which is no answer; a raw log's is a dead channel."""
    case = Case(programme, ("table", "A3"), number, whole=True)
    field, _, message = problem_of(client.post("/api/v1/sessions", content=case.content("EX-1")))
    if programme == "raw log":
        assert (field, "in every row while others of its kind change" in message) == ("A3", True)
    else:
        assert (field, "A3 did not respond to the rotation" in message) == ("sensors", True)


@pytest.mark.parametrize(("programme", "name"), [("two-axis-stand", "A1"), ("pulse gyroscopes", "G1")])
@one_engine
def test_a_channel_that_reads_the_same_at_every_position_is_questioned(
    client: httpx.Client, programme: str, name: str
) -> None:
    """A dead one became the unit's reference, and its diagnosis was full of nulls."""
    case = Case(programme, ("table", name), "1e6", whole=True)
    stored = client.post("/api/v1/sessions", content=case.content("EX-1")).json()
    assert (stored["state"], stored["is_reference"]) == ("questioned", False)
    assert (
        f"{name} has the same reading in every row, although its input changes: the sensor is dead" in stored["reason"]
    )
    told = client.get(f"/api/v1/sessions/{stored['id']}/diagnosis").json()["detail"]
    assert f"{name}: has the same reading in every row, so nothing can be estimated from it" in told
    assert client.get("/api/v1/jobs/failed").json()["failed"] == []


@pytest.mark.slow
@pytest.mark.parametrize("programme", list(programmes()))
@one_engine
def test_extreme_numbers_are_taken_or_refused(client: httpx.Client, programme: str) -> None:
    for number, case in enumerate([case for case in cases() if case.programme == programme][::EVERY]):
        answer = client.post("/api/v1/sessions", content=case.content(f"EX-{number}"))
        assert answer.status_code in {201, 422}, f"{case.name}: {answer.text}"
        if answer.status_code == 201:
            assert client.get(f"/api/v1/sessions/{answer.json()['id']}/calibration").status_code == 200, case.name
