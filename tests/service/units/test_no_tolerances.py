"""Units of a type for which nobody has entered tolerances, and their move to another type."""

import json
from typing import Any

import httpx
import pytest

from tests import builders
from tests.conftest import Holding
from tests.service.made_sessions import in_counts, session_bytes

SE = 6e-4
"""Standard error of a reading of consumer sensors: half a milli-g, V."""
MG = 1000.0
"""µg."""
SENTENCE = "Nobody has entered tolerances for accelerometer × 6, LSB"
DRIFTING, STEADY = "C-1", "C-2"


def months(unit: str, counts_a_volt: float, *moved: float) -> list[bytes]:
    """Sessions of a unit in successive months, each with a change of A3's bias, mg."""
    return [
        in_counts(unit, counts_a_volt, se=SE, seed=month, month=month, a3_moved=MG * mg)
        for month, mg in enumerate(moved, 1)
    ]


@pytest.fixture
def blocks(holding: Holding) -> httpx.Client:
    """Two blocks with converters of different range, one of which drifts by 10 mg."""
    return holding(*months(DRIFTING, 1e4, 0.0, 10.0), *months(STEADY, 4e4, 0.0, 0.0, 0.0))


def unit(client: httpx.Client, serial: str) -> Any:
    """The unit as the API has it."""
    return client.get(f"/api/v1/units/{serial}").json()


def test_a_drift_is_flagged_without_tolerances_and_its_unit_must_not_be_used(blocks: httpx.Client) -> None:
    drifting, steady = unit(blocks, DRIFTING), unit(blocks, STEADY)
    assert drifting["unit_type"]["name"] != steady["unit_type"]["name"]
    assert (drifting["summary"]["verdict"], steady["summary"]["verdict"]) == ("fail", "pass")
    assert drifting["summary"]["worst_sensor"] == "A3"
    flags = blocks.get(f"/api/v1/units/{DRIFTING}/flags").json()["flags"]
    assert [(flag["matter"], flag["place"]) for flag in flags] == [("out-of-tolerance", "A3")]
    assert blocks.get(f"/api/v1/units/{DRIFTING}/usable").json()["usable"] is False
    flags = blocks.get(f"/api/v1/units/{STEADY}/flags").json()["flags"]
    assert {flag["matter"] for flag in flags} <= {"overdue"}


def test_it_is_said_wherever_the_verdict_stands(blocks: httpx.Client) -> None:
    known = unit(blocks, DRIFTING)
    session = known["summary"]["last_session"]
    assert SENTENCE in blocks.get(f"/api/v1/sessions/{session}").json()["reason"]
    for page in (f"/sessions/{session}", f"/units/{DRIFTING}"):
        text = blocks.get(page).text
        assert SENTENCE in text
        assert "?proposed=true#tolerances" in text


def test_a_worse_session_than_the_reference_decides_nothing(holding: Holding) -> None:
    worse = in_counts(DRIFTING, 1e4, se=20 * SE, month=2)
    assert unit(holding(*months(DRIFTING, 1e4, 0.0), worse), DRIFTING)["summary"]["verdict"] == "undecidable"


def test_a_fine_unit_is_judged_by_the_defaults(holding: Holding) -> None:
    client = holding(session_bytes(), session_bytes(seed=2, month=5, a3_moved=20.0))
    decisions = client.get(f"/api/v1/sessions/{unit(client, 'BA-017')['summary']['last_session']}").json()["decisions"]
    (bias,) = {d["tolerance"] for d in decisions if d["parameter"] == "bias"}
    assert bias == pytest.approx(50 * 9.80665e-6)


def test_a_proposal_that_is_entered_judges_the_stored_sessions(blocks: httpx.Client) -> None:
    kind = unit(blocks, DRIFTING)["unit_type"]
    address = f"/api/v1/unit-types/{kind['name']}"
    proposal = blocks.get(f"{address}/proposal").json()
    assert 0.3e-3 < proposal["tolerances"]["bias"] / 9.80665 < 3e-3
    assert (
        f'value="{proposal["tolerances"]["bias"] / 9.80665e-6:.12g}"'
        in blocks.get(f"/unit-types/{kind['name']}?proposed=true").text
    )
    assert blocks.put(address, json=proposal | {"stored_sessions": True}).json()["are_entered"] is True
    found = unit(blocks, DRIFTING)
    session = blocks.get(f"/api/v1/sessions/{found['summary']['last_session']}").json()
    assert session["verdict"] == "fail"
    assert "Nobody" not in session["reason"]
    bias = {d["tolerance"] for d in session["decisions"] if d["parameter"] == "bias"}
    assert bias == {proposal["tolerances"]["bias"]}


def test_tolerances_judge_stored_sessions_where_somebody_says_so(blocks: httpx.Client) -> None:
    name = unit(blocks, DRIFTING)["unit_type"]["name"]
    wide = {"scale": 0.1, "bias": 1.0, "quadratic": None, "axis": 0.1}
    blocks.put(f"/api/v1/unit-types/{name}", json={"tolerances": wide})
    assert unit(blocks, DRIFTING)["summary"]["verdict"] == "fail"
    same = {"tolerances": wide, "stored_sessions": True}
    assert blocks.put(f"/api/v1/unit-types/{name}", json=same).json()["revision"] == 3
    assert unit(blocks, DRIFTING)["summary"]["verdict"] == "pass"


@pytest.mark.parametrize("page", [False, True])
def test_a_unit_moves_to_another_type_and_everything_follows(blocks: httpx.Client, page: bool) -> None:
    name, other = unit(blocks, DRIFTING)["unit_type"]["name"], unit(blocks, STEADY)["unit_type"]["name"]
    new = {"unit_type": "MEMS-9", "by": "K. Ito", "why": "the maker's name"}
    if page:
        blocks.post(f"/units/{DRIFTING}/type", data=new, follow_redirects=True).raise_for_status()
    else:
        assert blocks.put(f"/api/v1/units/{DRIFTING}/type", json=new).json()["name"] == "MEMS-9"
    found = unit(blocks, DRIFTING)
    assert (found["unit_type"]["name"], found["summary"]["verdict"]) == ("MEMS-9", "fail")
    session = blocks.get(f"/api/v1/sessions/{found['summary']['last_session']}").json()
    assert {d["rule"].partition("(")[2] for d in session["decisions"]} == {"MEMS-9 rev 1)"}
    assert [blocks.get(f"/unit-types/{kind}").status_code for kind in (name, "MEMS-9")] == [200, 200]
    fleet = {
        kind: blocks.get("/api/v1/units", params={"unit_type": kind}).json()["units"]
        for kind in (name, "MEMS-9", other)
    }
    assert {kind: len(units) for kind, units in fleet.items()} == {name: 0, "MEMS-9": 1, other: 1}
    audit = blocks.get("/api/v1/audit", params={"subject": DRIFTING}).json()["lines"]
    assert [line["details"]["before"] for line in audit if line["action"] == "type"] == [name]


def test_a_unit_does_not_move_to_a_type_of_other_sensors(holding: Holding) -> None:
    client = holding(*months(DRIFTING, 1e4, 0.0), session_bytes(unit="BA-4", m=4))
    name = unit(client, "BA-4")["unit_type"]["name"]
    answer = client.put(f"/api/v1/units/{DRIFTING}/type", json={"unit_type": name, "by": "K. Ito", "why": "a slip"})
    assert answer.status_code == 422
    (problem,) = answer.json()["problems"]
    assert problem["field"] == "unit_type"
    assert "4 accelerometers" in problem["message"]
    assert "6 accelerometers" in problem["message"]


def test_a_block_with_gyros_moves_to_a_new_type_and_back(holding: Holding) -> None:
    client = holding(json.dumps(builders.mixed_block()).encode())
    (known,) = client.get("/api/v1/units").json()["units"]
    for name in ("MEMS-9", known["unit_type"]):
        answer = client.put(
            f"/api/v1/units/{known['serial']}/type", json={"unit_type": name, "by": "K. Ito", "why": "the maker's name"}
        )
        assert (answer.status_code, answer.json().get("name")) == (200, name), answer.text


def test_a_partial_first_session_decides_nothing(holding: Holding) -> None:
    """Six faces show no quadratic term; the whole programme afterwards is judged by it, against what it lacks."""
    whole = json.loads(session_bytes(unit="BA-9", month=5))
    rows = range(6)
    part = whole | {"started_at": "2026-04-01T09:00:00Z"}
    part["table"] = {name: [column[i] for i in rows] for name, column in whole["table"].items()}
    client = holding(json.dumps(part).encode(), json.dumps(whole).encode())
    known = unit(client, "BA-9")
    assert None not in known["unit_type"]["tolerances"].values()
    session = client.get(f"/api/v1/sessions/{known['summary']['last_session']}").json()
    assert "is not in the reference session" in session["reason"]
