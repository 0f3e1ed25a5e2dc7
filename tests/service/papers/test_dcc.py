"""The Digital Calibration Certificate: its structure, its numbers, and texts that stay texts."""

import json
from datetime import UTC, datetime
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import httpx
import pytest

from service.papers.verifying.records import Outcome, RawFile
from service.papers.verifying.verify import Beside, verify
from tests.builders import accelerometer_block, arbitrary_orientations, gyro_block, mixed_block, raw_log
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.diagnosed import send
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.papers.schema import DCC, SI, faults
from tests.service.turntable import alignment_bytes


def dcc(client: httpx.Client, id: str) -> Element:
    """The certificate as a tree."""
    answer = client.get(f"/api/v1/sessions/{id}/certificate?format=dcc")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/xml"), answer.text
    return ElementTree.fromstring(answer.content)


def quantity(root: Element, sensor: str, name: str) -> Element:
    """A quantity of a sensor."""
    [result] = [r for r in root.iter(f"{DCC}result") if text(r).endswith(f" {sensor}")]
    [found] = [q for q in result.iter(f"{DCC}quantity") if text(q) == name]
    return found


def found(root: Element, sensor: str, name: str) -> dict[str, str]:
    """Value, unit, U and k of a quantity of a sensor."""
    si = [element for element in quantity(root, sensor, name).iter() if element.tag.startswith(SI)]
    return {element.tag.replace(SI, ""): element.text or "" for element in si}


def text(element: Element) -> str:
    """Name of an element."""
    return element.findtext(f"{DCC}name/{DCC}content") or ""


ID = session_id(FAILED[-1])
SESSIONS = {
    "accelerometers": accelerometer_block(),
    "gyros": gyro_block(),
    "mixed": mixed_block(),
    "orientations": arbitrary_orientations(),
    "raw": raw_log(),
    "turntable": json.loads(alignment_bytes()),
}


@pytest.mark.parametrize("name", SESSIONS)
def test_every_element_is_where_the_schema_wants_it_and_can_be_computed_again(client: httpx.Client, name: str) -> None:
    id = send(client, SESSIONS[name])
    assert faults(dcc(client, id)) == []
    content, raw = (client.get(f"/api/v1/sessions/{id}/{path}").content for path in ("certificate?format=dcc", "file"))
    found = verify(content, RawFile(f"{name}.json", raw), Beside(), datetime.now(UTC))
    assert found.outcome is Outcome.AGREES, found


@pytest.fixture
def failed(holding: Holding) -> httpx.Client:
    """A service that holds a reference and a session out of tolerance."""
    return holding(*FAILED, diagnosed=True)


def test_numbers_are_the_calibration_s_in_si(failed: httpx.Client) -> None:
    root = dcc(failed, ID)
    calibration = failed.get(f"/api/v1/sessions/{ID}/calibration").json()
    a3 = calibration["sensors"][2]
    bias = found(root, "A3", "bias")
    assert float(bias["value"]) == a3["bias"]["value"]
    assert float(bias["valueExpandedMU"]) == pytest.approx(2 * a3["bias"]["sigma"], rel=1e-12)
    assert (bias["unit"], bias["coverageFactor"], bias["coverageProbability"]) == (
        r"\metre\second\tothe{-2}",
        "2",
        "0.9545",
    )
    assert found(root, "A3", "scale, in V per input")["unit"] == r"\volt\metre\tothe{-1}\second\tothe{2}"


def test_deviations_carry_tolerance_and_conformity(failed: httpx.Client) -> None:
    root = dcc(failed, ID)
    decisions = failed.get(f"/api/v1/sessions/{ID}").json()["decisions"]
    [a3] = [d for d in decisions if (d["sensor"], d["parameter"]) == ("A3", "bias")]
    values = quantity(root, "A3", "bias, deviation from the reference").iter(f"{SI}value")
    stated = [a3[name] for name in ("deviation", "tolerance", "guard_band", "probability_out")]
    assert [float(value.text or "") for value in values] == stated
    conformities = [element.text for element in root.iter(f"{DCC}conformity")]
    assert conformities.count("fail") == 1 + sum(d["verdict"] == "fail" for d in decisions)
    assert faults(root) == []


def test_it_names_the_input_the_model_and_the_software(failed: httpx.Client) -> None:
    content = failed.get(f"/api/v1/sessions/{ID}/certificate?format=dcc").content
    session = failed.get(f"/api/v1/sessions/{ID}").json()
    for stated in (session["sha256"], "Model revision 0", "imu-health", "K. Ito", "BA-017", "ILAC-G8-four-state"):
        assert stated.encode() in content
    assert failed.get(f"/api/v1/sessions/{ID}/certificate?format=dcc").content == content


@pytest.mark.parametrize("name", ["<dcc:fail/>&amp;", "王芳 ]]>", "", "\U0001f600"])
def test_no_text_is_taken_for_markup(client: httpx.Client, name: str) -> None:
    answer = client.post("/api/v1/sessions", content=session_bytes(operator=name, notes=name))
    root = dcc(client, answer.json()["id"])
    person = root.find(f".//{DCC}person")
    assert person is not None
    assert text(person) == (" ".join(name.split()) or "not stated")
    assert faults(root) == []


def test_a_fault_of_the_structure_would_be_seen(client: httpx.Client) -> None:
    root = dcc(client, send(client, accelerometer_block()))
    core = root.find(f".//{DCC}coreData")
    value = root.find(f".//{SI}valueExpandedMU")
    assert core is not None
    assert value is not None
    core[:] = reversed(list(core))
    value.text = "-1.0"
    assert [fault.split()[0] for fault in faults(root)] == ["coreData", "si:valueExpandedMU"]
