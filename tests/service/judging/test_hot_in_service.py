"""A recording far from the calibration's temperature: a change decides nothing, and that is said at once."""

import json

from tests.conftest import Holding
from tests.service.made_sessions import session_bytes, session_id
from tests.service.recordings import recording_document


def at(celsius: float, document: dict) -> bytes:
    """The document at a temperature."""
    rows = len(document["table"]["A1"])
    return json.dumps(document | {"table": document["table"] | {"temperature_c": [celsius] * rows}}).encode()


def test_a_change_far_from_the_calibration_is_undecided_before_causes_are_looked_for(holding: Holding) -> None:
    reference = at(20.0, json.loads(session_bytes()))
    hot = at(45.0, recording_document(a3_moved=2500.0))
    client = holding(reference, hot)
    found = client.get(f"/api/v1/sessions/{session_id(hot)}").json()
    assert found["verdict"] == "undecidable"
    assert "measure again at about 20\u00a0°C, or calibrate over temperature" in found["reason"]
    assert client.get("/api/v1/units/BA-017/flags").json()["flags"] == []
    use = client.get("/api/v1/units/BA-017/usable").json()
    assert use["use"] == "Do not use: repeat the session"
    assert "25\u00a0°C above" in use["why"]


def test_at_the_calibrations_temperature_it_is_unfit(holding: Holding) -> None:
    reference = at(20.0, json.loads(session_bytes()))
    same = at(22.0, recording_document(a3_moved=2500.0))
    assert holding(reference, same).get(f"/api/v1/sessions/{session_id(same)}").json()["verdict"] == "fail"
