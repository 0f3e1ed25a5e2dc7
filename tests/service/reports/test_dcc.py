"""The Digital Calibration Certificate: its structure, its numbers, and texts that stay texts."""

import json
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import httpx
import pytest

from tests.builders import accelerometer_block, arbitrary_orientations, gyro_block, mixed_block, raw_log
from tests.service.diagnosed import send
from tests.service.reports.schema import DCC, SI, faults
from tests.service.sessions import session_bytes
from tests.service.turntable import alignment_bytes


def dcc(client: httpx.Client, id: str) -> Element:
    """The certificate as a tree."""
    answer = client.get(f"/api/v1/sessions/{id}/certificate?format=dcc")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/xml"), answer.text
    return ElementTree.fromstring(answer.content)


def found(root: Element, sensor: str, quantity: str) -> dict[str, str]:
    """Value, unit, U and k of a quantity of a sensor."""
    [result] = [r for r in root.iter(f"{DCC}result") if text(r).endswith(f" {sensor}")]
    [one] = [q for q in result.iter(f"{DCC}quantity") if text(q) == quantity]
    return {element.tag.replace(SI, ""): element.text or "" for element in one.iter() if element.tag.startswith(SI)}


def text(element: Element) -> str:
    """What an element is called."""
    return element.findtext(f"{DCC}name/{DCC}content") or ""


SESSIONS = {
    "accelerometers": accelerometer_block(),
    "gyros": gyro_block(),
    "mixed": mixed_block(),
    "orientations": arbitrary_orientations(),
    "raw": raw_log(),
    "turntable": json.loads(alignment_bytes()),
}


@pytest.mark.parametrize("name", SESSIONS)
def test_every_element_is_where_the_schema_wants_it(client: httpx.Client, name: str) -> None:
    assert faults(dcc(client, send(client, SESSIONS[name]))) == []


@pytest.fixture
def failed(client: httpx.Client) -> dict[str, Any]:
    """A session in which A3's bias moved far beyond its tolerance."""
    client.post("/api/v1/sessions", content=session_bytes(seed=1))
    answer = client.post("/api/v1/sessions", content=session_bytes(seed=2, month=5, a3_moved=200.0))
    receipt: dict[str, Any] = answer.json()
    return receipt


def test_numbers_are_the_calibration_s_in_si(client: httpx.Client, failed: dict[str, Any]) -> None:
    root = dcc(client, failed["id"])
    calibration = client.get(f"/api/v1/sessions/{failed['id']}/calibration").json()
    a3 = calibration["sensors"][2]
    bias = found(root, "A3", "bias")
    assert float(bias["value"]) == a3["bias"]["value"]
    assert float(bias["uncertainty"]) == pytest.approx(2 * a3["bias"]["sigma"], rel=1e-12)
    assert (bias["unit"], bias["coverageFactor"], bias["coverageProbability"]) == (
        r"\metre\second\tothe{-2}",
        "2",
        "0.9545",
    )
    assert found(root, "A3", "scale, in V per input")["unit"] == r"\volt\metre\tothe{-1}\second\tothe{2}"


def test_deviations_carry_tolerance_and_conformity(client: httpx.Client, failed: dict[str, Any]) -> None:
    root = dcc(client, failed["id"])
    decisions = client.get(f"/api/v1/sessions/{failed['id']}").json()["decisions"]
    [a3] = [d for d in decisions if (d["sensor"], d["parameter"]) == ("A3", "bias")]
    assert float(found(root, "A3", "bias, deviation from the reference")["value"]) in (a3["deviation"], a3["tolerance"])
    stated = [element.text for element in root.iter(f"{DCC}conformity")]
    assert stated.count("fail") == 1 + sum(d["verdict"] == "fail" for d in decisions)
    assert faults(root) == []


def test_it_names_the_input_the_model_and_the_software(client: httpx.Client, failed: dict[str, Any]) -> None:
    content = client.get(f"/api/v1/sessions/{failed['id']}/certificate?format=dcc").content
    session = client.get(f"/api/v1/sessions/{failed['id']}").json()
    for stated in (session["sha256"], "Model revision 0", "imu-health", "K. Ito", "BA-017", "ILAC-G8-four-state"):
        assert stated.encode() in content
    again = client.get(f"/api/v1/sessions/{failed['id']}/certificate?format=dcc").content
    assert content == again


@pytest.mark.parametrize("name", ["<dcc:fail/>&amp;", "王芳 ]]>", "  a\x0bb  ", "", "\U0001f600"])
def test_no_text_is_taken_for_markup(client: httpx.Client, name: str) -> None:
    answer = client.post("/api/v1/sessions", content=session_bytes(operator=name, notes=name))
    if answer.status_code == 422:
        assert "\x0b" in name
        return
    root = dcc(client, answer.json()["id"])
    person = root.find(f".//{DCC}person")
    assert person is not None
    assert text(person) == (" ".join(name.split()) or "not stated")
    assert faults(root) == []


def test_a_fault_of_the_structure_would_be_seen(client: httpx.Client) -> None:
    root = dcc(client, send(client, accelerometer_block()))
    core = root.find(f".//{DCC}coreData")
    value = root.find(f".//{SI}uncertainty")
    assert core is not None
    assert value is not None
    core[:] = reversed(list(core))
    value.text = "-1.0"
    assert [fault.split()[0] for fault in faults(root)] == ["coreData", "si:uncertainty"]
