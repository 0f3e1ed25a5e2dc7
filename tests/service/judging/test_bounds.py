"""A change beyond any gravity, stand or sensor is the unit's or a slip: the unit is never fit, for a reason given."""

import json

import httpx
import numpy as np
import pytest

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes, session_id
from tests.service.recordings import recording_document

REFERENCE = session_bytes(month=1)
SOUND = session_bytes(seed=3, month=3)


def scaled(factor: float, latitude: float | None = None, **changes: object) -> bytes:
    """A later session whose readings are all by a factor larger; ``latitude`` is what its file states, degrees."""
    document = json.loads(session_bytes(seed=2, month=2)) | changes
    for sensor in document["sensors"]:
        for key in {sensor["name"], f"{sensor['name']}_se"} & document["table"].keys():
            document["table"][key] = [factor * value for value in document["table"][key]]
    if latitude is not None:
        document["site"] = {"latitude_deg": latitude, "height_m": 160.0}
    return json.dumps(document).encode()


def session(client: httpx.Client, content: bytes) -> dict:
    return client.get(f"/api/v1/sessions/{session_id(content)}").json()


@pytest.mark.parametrize("factor", [0.9, 1.002, 1.01, 1.5])
def test_a_common_factor_beyond_gravity_is_the_units(holding: Holding, factor: float) -> None:
    client = holding(REFERENCE, later := scaled(factor), SOUND, diagnosed=True)
    found = session(client, later)
    assert found["verdict"] == "fail"
    assert (
        "more than gravity at the stated place can: check the supply voltage, the converter's reference, the range"
        in found["reason"]
    )
    after = session(client, SOUND)
    assert (after["verdict"], after["reservations"]) == ("pass", [])


def test_a_common_factor_that_gravity_elsewhere_explains_is_no_fault_of_the_unit(holding: Holding) -> None:
    """Two degrees of latitude wrong: the file says so, and gravity in it is 0.02 % off."""
    client = holding(REFERENCE, later := scaled(1.0, latitude=57.81), diagnosed=True)
    found = session(client, later)
    assert found["verdict"] == "pass"
    assert [r["cause"] for r in found["reservations"]] == ["gravity-entry"]


def test_a_bias_that_no_sensor_has_is_questioned(holding: Holding) -> None:
    document = json.loads(REFERENCE)
    document["sensors"][0]["nominal_offset"] = 0.0
    name, scale = document["sensors"][0]["name"], document["sensors"][0]["nominal_scale"]
    document["table"][name] = [value + 30.0 * scale for value in document["table"][name]]
    content = json.dumps(document).encode()
    found = session(holding(content), content)
    assert found["state"] == "questioned"
    assert "The bias of A1 is" in found["reason"]


def test_a_recording_in_another_unit_is_questioned(holding: Holding) -> None:
    document = recording_document()
    for sensor in document["sensors"]:
        document["table"][sensor["name"]] = (np.array(document["table"][sensor["name"]]) / 9.80665).tolist()
    content = json.dumps(document).encode()
    found = session(holding(REFERENCE, content), content)
    assert found["state"] == "questioned"
    assert "g throughout" in found["reason"]
