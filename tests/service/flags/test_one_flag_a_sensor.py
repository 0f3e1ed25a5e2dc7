"""A sensor out of tolerance has one flag with its cause, and accepting the cause resolves it."""

import json

import pytest

from estimator.json_object import Json
from estimator.session import ACCELEROMETER
from estimator.writing import session_document
from tests.conftest import Holding
from tests.estimator.causes.hiding import change, scene, with_readings
from tests.service.diagnosed import dated
from tests.service.made_sessions import session_id

ACCEPT = {"cause": "cubic-nonlinearity", "scope": "unit", "by": "K. Ito"}
MANY = 12.0
"""Size of what is hidden, beside the one of the tests of its cause: the scale factor leaves its tolerance."""


@pytest.fixture
def files() -> tuple[bytes, bytes]:
    """A sound session of a unit, and one in which A2 is cubic."""
    where = scene(ACCELEROMETER, 2)
    cubic = with_readings(where.measured(2), MANY * change("cubic-nonlinearity", where) * where.world.truth.scale)
    sound = session_document(where.measured(1)) | {"unit": "CUBE-1", "started_at": "2026-01-05T08:00:00Z"}
    return json.dumps(sound).encode(), json.dumps(dated(cubic, "CUBE-1")).encode()


def test_one_flag_says_what_is_out_and_why_until_the_cause_is_accepted(
    holding: Holding, files: tuple[bytes, bytes]
) -> None:
    client = holding(*files, diagnosed=True)

    def flags() -> list[Json]:
        found: list[Json] = client.get("/api/v1/units/CUBE-1/flags").json()["flags"]
        return found

    def verdict() -> str:
        return str(client.get(f"/api/v1/sessions/{session_id(files[1])}").json()["verdict"])

    assert verdict() == "fail"
    [flag] = [flag for flag in flags() if flag["state"] == "raised"]
    assert (flag["matter"], flag["place"]) == ("out-of-tolerance", "A2")
    assert "beyond the tolerance" in flag["summary"]
    assert "A2 has a cubic nonlinearity" in flag["summary"]
    client.post(f"/api/v1/sessions/{session_id(files[1])}/diagnosis/accept", json=ACCEPT).raise_for_status()
    assert [flag for flag in flags() if flag["state"] != "resolved"] == []
    assert verdict() == "pass"


def test_a_resolved_flag_stays_resolved_with_its_cause(holding: Holding, files: tuple[bytes, bytes]) -> None:
    client = holding(*files, diagnosed=True)
    path = "/api/v1/units/CUBE-1/flags"
    [flag] = [flag for flag in client.get(path).json()["flags"] if flag["state"] == "raised"]
    client.post(
        f"/api/v1/flags/{flag['id']}/resolve", json={"by": "K. Ito", "why": "A2 is repaired"}
    ).raise_for_status()
    client.post(f"/api/v1/sessions/{session_id(files[0])}/reference", json={"by": "K. Ito", "why": "again"})
    assert {flag["state"] for flag in client.get(path).json()["flags"]} == {"resolved"}
