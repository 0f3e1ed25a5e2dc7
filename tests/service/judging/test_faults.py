"""A sensor that begins to fail in a recording in service makes its unit unfit, and every answer says so alike."""

import json
from typing import Any

import httpx
import pytest

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.public_cases import CASES
from tests.service.faulty_recordings import SPOILT, faulty_bytes
from tests.service.made_sessions import session_bytes, session_id
from tests.service.recordings import recording_bytes

CASE = CASES / "fault-begins-in-service"
SINCE = "since 09:02:00 UTC (120 s into the recording)"
STUCK = f"A3 has stood still {SINCE}: replace or repair A3, and check its channel and its plug."
SAID = {
    "step": ("The bias of A3 has been off by +", "replace or repair A3."),
    "ramp": ("The bias of A3 has been drifting by +", "replace or repair A3."),
    "stuck": ("A3 has stood still", "replace or repair A3, and check its channel and its plug."),
    "zero": ("A3 has read zero", "replace or repair A3, and check its channel and its plug."),
    "full-scale": ("A3 has stood at the end of its range", "replace or repair A3, and check its channel and its plug."),
    "gain": ("The scale factor of A3 has been off by +", "replace or repair A3."),
    "noise": ("A3 has been too noisy, with ", "check the mounting and the supply of A3; replace it if both are sound."),
    "delay": ("The readings of A3 have come late by ", "check the filter and the sampling of the channel of A3."),
    "intermittent": ("A3 has been off now and then by ", "check the connector of A3."),
    "exchanged": ("A1 and A4 have been exchanged", "and upload the recording again corrected."),
}


def answers(client: httpx.Client, recording: bytes) -> tuple[dict[str, Any], dict[str, Any], list[dict[str, Any]]]:
    """The recording, whether its unit may be used, and the unit's flags."""
    session = client.get(f"/api/v1/sessions/{session_id(recording)}").json()
    unit = f"/api/v1/units/{session['unit']}"
    return session, client.get(f"{unit}/usable").json(), client.get(f"{unit}/flags").json()["flags"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*SPOILT, "exchanged"])
def test_every_kind_has_its_sentence(holding: Holding, kind: str) -> None:
    recording = faulty_bytes(kind)
    session, use, flags = answers(holding(session_bytes(), recording), recording)
    assert session["verdict"] == "fail"
    assert session["reason"].startswith(SAID[kind][0])
    assert session["reason"].endswith(SAID[kind][1])
    assert use["usable"] is False
    assert [flag["summary"] for flag in flags] == [session["reason"]]


def test_a_sensor_that_stands_still_is_said_alike_everywhere(holding: Holding) -> None:
    recording = faulty_bytes("stuck")
    client = holding(session_bytes(), recording)
    session, use, [flag] = answers(client, recording)
    assert (session["verdict"], session["reason"]) == ("fail", STUCK)
    assert (flag["matter"], flag["place"], flag["summary"]) == ("out-of-tolerance", "A3", STUCK)
    assert (use["usable"], use["answer"]) == (False, "no")
    assert use["why"] == STUCK
    assert use["action"] == "replace or repair A3, and check its channel and its plug"
    page = client.get(f"/sessions/{session['id']}").text
    assert "A3 stands still" in page
    assert "The sensors agree" not in page
    assert "Before that: no change since the calibration." in page
    unit = client.get("/units/BA-017").text
    assert "Do not use</h1>" in unit
    assert "Replace or repair A3, and check its channel and its plug." in unit


def test_the_history_keeps_what_the_part_before_says(holding: Holding) -> None:
    recording = faulty_bytes("step")
    client = holding(session_bytes(), recording)
    history = client.get("/api/v1/units/BA-017/history", params={"parameter": "bias"}).json()["points"]
    first = {p["sensor"]: p["value"] for p in history if p["session"] == session_id(session_bytes())}
    last = {p["sensor"]: p for p in history if p["session"] == session_id(recording)}
    assert all(abs(last[name]["value"] - first[name]) < 5e-4 for name in first)
    assert [p["sensor"] for p in last.values() if p["verdict"] == "fail"] == ["A3"]


def test_a_later_sound_recording_proposes_to_resolve_the_flag_and_no_more(holding: Holding) -> None:
    faulty, sound = faulty_bytes("stuck"), json.loads(recording_bytes(seed=4)) | {"started_at": "2026-06-01T09:00:00Z"}
    client = holding(session_bytes(), faulty, json.dumps(sound).encode())
    [flag] = client.get("/api/v1/units/BA-017/flags").json()["flags"]
    assert (flag["state"], flag["proposal"][:31]) == ("raised", "The session of 1 Jun 2026 finds")
    assert client.get("/api/v1/units/BA-017/usable").json()["usable"] is False


def test_four_sensors_cannot_say_which_of_them_it_is(holding: Holding) -> None:
    recording = faulty_bytes("noise", m=4)
    session, use, [flag] = answers(holding(session_bytes(m=4), recording), recording)
    assert session["verdict"] == "fail"
    assert "ne of the sensors A1, A2, A3, A4 has" in session["reason"]
    assert "the redundancy is too small to say which: calibrate the unit" in session["reason"]
    assert (flag["place"], use["usable"]) == ("", False)


@pytest.mark.skipif(not CASE.is_dir(), reason=f"no cases in {CASES}; set IMU_HEALTH_CASES to their folder")
@pytest.mark.parametrize(
    ("file", "says"),
    [("frozen", "A3 has stood still since 09:02:00 UTC"), ("step-100mg", "The bias of A3 has been off by +")],
)
def test_the_public_cases_are_unfit(client: httpx.Client, file: str, says: str) -> None:
    client.post("/api/v1/sessions", content=(CASE / "reference.json").read_bytes())
    answer = client.post("/api/v1/sessions", content=(CASE / f"{file}.json").read_bytes()).json()
    assert (answer["verdict"], answer["reason"][: len(says)]) == ("fail", says)
    assert client.get("/api/v1/units/ST-1/usable").json()["usable"] is False
