"""Reservations follow from the records, not by the order in which they came and were looked at."""

import json
from typing import Any
from urllib.parse import quote

import httpx
import pytest

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.doubtful import REFERENCE, jumped
from tests.service.made_sessions import session_bytes

BY = {"by": "K. Ito", "why": "another look"}
MOVED = session_bytes(seed=2, month=2, a3_moved=90.0)
"""A session whose A3 has another zero than in `REFERENCE`; by itself there is nothing to report."""


def in_another_unit(content: bytes) -> bytes:
    """The session with readings in mV for V, so that it is questioned."""
    document = json.loads(content)
    names = [name for name in document["table"] if name.startswith("A")]
    document["table"] |= {name: [1e3 * x for x in document["table"][name]] for name in names}
    return json.dumps(document).encode()


def four_times_as_wide(client: httpx.Client) -> None:
    """Other tolerances, from the next session on."""
    [kind] = client.get("/api/v1/unit-types").json()["unit_types"]
    wider = {name: value and 4 * value for name, value in kind["tolerances"].items()}
    client.put(f"/api/v1/unit-types/{quote(kind['name'])}", json={"tolerances": wider}).raise_for_status()


def chosen(client: httpx.Client, id: str) -> None:
    """The session becomes its unit's reference."""
    client.post("/api/v1/units/BA-017/reference", json=BY | {"session": id}).raise_for_status()


def sent(client: httpx.Client, content: bytes, **params: str) -> str:
    """The id of an uploaded session."""
    answer = client.post("/api/v1/sessions", content=content, params=params)
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def done(client: httpx.Client, id: str, what: str, **more: Any) -> None:
    """Does to a session what an engineer may do."""
    client.post(f"/api/v1/sessions/{id}/{what}", json=BY | more).raise_for_status()


def looked_at(client: httpx.Client, id: str) -> tuple[Any, Any]:
    """Findings of a session's diagnosis, and the reservations of its verdict."""
    found = client.get(f"/api/v1/sessions/{id}/diagnosis").json()
    named = [(one["cause"], one["sensors"], one["amplitude"]) for one in found["findings"]]
    return named, client.get(f"/api/v1/sessions/{id}").json()["reservations"]


@pytest.mark.slow
@pytest.mark.parametrize("first", ["tolerances", "reference"])
def test_other_tolerances_weigh_only_what_is_computed_from_then_on(holding: Holding, first: str) -> None:
    client = holding(REFERENCE)
    id = sent(client, jumped(51.0))
    looked_at(client, id)
    steps = {"tolerances": lambda: four_times_as_wide(client), "reference": lambda: chosen(client, id)}
    for step in sorted(steps, key=lambda name: name != first):
        steps[step]()
    _, [reservation] = looked_at(client, id)
    assert (reservation["cause"], reservation["share"]) == ("bias-jump", pytest.approx(1.0, abs=0.1))


def test_what_stands_for_an_earlier_session_is_not_compared_with_it(holding: Holding) -> None:
    client = holding(REFERENCE)
    [earlier] = client.get("/api/v1/sessions").json()["sessions"]
    id = sent(client, MOVED)
    named, _ = looked_at(client, id)
    assert named
    done(client, earlier["id"], "supersede", superseded_by=id)
    alone = holding()
    assert looked_at(client, id) == looked_at(alone, sent(alone, MOVED)) == ([], [])


@pytest.mark.slow
def test_a_questioned_session_is_looked_at_again_once_it_is_accepted(holding: Holding) -> None:
    """The sessions have three sensors: beside the earlier one all of it seems new, and every sensor more costs
    seconds.
    """
    found = []
    for is_looked_at in (True, False):
        client = holding(session_bytes(month=1, m=3))
        id = sent(client, in_another_unit(jumped(51.0, m=3)))
        if is_looked_at:
            looked_at(client, id)
        done(client, id, "accept")
        found.append(looked_at(client, id))
    assert found[0] == found[1]


def test_a_session_that_is_judged_again_names_the_tolerances_that_it_is_judged_by(holding: Holding) -> None:
    client = holding(REFERENCE)
    id = sent(client, MOVED)
    [reference] = [one["id"] for one in client.get("/api/v1/sessions").json()["sessions"] if one["is_reference"]]
    four_times_as_wide(client)
    chosen(client, id)
    decided = client.get(f"/api/v1/sessions/{reference}").json()["decisions"]
    assert {one["rule"].split()[-1] for one in decided} == {"1)"}
    assert max(one["tolerance"] for one in decided if one["parameter"] == "scale") == 1e-4
