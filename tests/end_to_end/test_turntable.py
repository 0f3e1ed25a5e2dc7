"""Alignments and rate tables from upload to history and pages, over HTTP; what is stored, on both databases."""

import json

import httpx
import pytest

from estimator.results import ARCSEC
from tests.databases import ENGINES
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.made_sessions import session_bytes
from tests.service.turntable import MICRO_G, alignment_bytes, rate_table_bytes

SESSIONS = "/api/v1/sessions"
HISTORY = "/api/v1/units/RA-1/history"


def post(client: httpx.Client, content: bytes) -> dict[str, str]:
    """The receipt of an upload that is taken."""
    answer = client.post(SESSIONS, content=content)
    assert answer.status_code == 201, answer.text
    receipt: dict[str, str] = answer.json()
    return receipt


def points(client: httpx.Client, sensor: str, parameter: str) -> list[dict[str, float]]:
    """The history of one parameter."""
    answer = client.get(HISTORY, params={"sensor": sensor, "parameter": parameter})
    found: list[dict[str, float]] = answer.json()["points"]
    return found


def test_every_error_of_an_alignment_enters_the_history_with_sigma_and_tolerance(client: httpx.Client) -> None:
    post(client, alignment_bytes())
    post(client, alignment_bytes(seed=2, month=4))
    told = [("acc x", "bias"), ("acc y", "bias"), ("gyro x", "bias"), ("gyro y", "bias"), ("gyro z", "bias")]
    told += [("gyro x", "misalignment"), ("gyro y", "misalignment"), ("gyro z", "scale")]
    for sensor, parameter in told:
        first, second = points(client, sensor, parameter)
        assert first["value"] == second["reference"]
        assert second["u"] > 0
        assert second["tolerance"] > 0
        assert second["verdict"] == "pass"
    assert len(client.get(HISTORY).json()["points"]) == 2 * len(told)


def test_the_mounting_errors_are_those_of_the_block(client: httpx.Client) -> None:
    post(client, alignment_bytes())
    for sensor, true in (("gyro x", 4 * ARCSEC), ("gyro y", 8 * ARCSEC)):
        (point,) = points(client, sensor, "misalignment")
        assert abs(point["value"] - true) < 4 * point["u"]


def test_a_moved_accelerometer_zero_fails_without_a_stand(client: httpx.Client) -> None:
    post(client, alignment_bytes())
    receipt = post(client, alignment_bytes(seed=2, month=4, x_moved=200.0))
    assert receipt["verdict"] == "fail"
    assert receipt["reason"].startswith("acc x bias changed by +")
    assert "µg), beyond the tolerance of ±50 µg." in receipt["reason"]
    (_, moved) = points(client, "acc x", "bias")
    assert moved["value"] == pytest.approx(200 * MICRO_G, abs=20 * MICRO_G)


def test_a_turned_gyro_fails(client: httpx.Client) -> None:
    post(client, alignment_bytes())
    receipt = post(client, alignment_bytes(seed=2, month=4, mounting=(4 * ARCSEC, 408 * ARCSEC)))
    assert (receipt["verdict"], receipt["reason"][:27]) == ("fail", "gyro y misalignment changed")


def test_a_rate_table_is_judged_against_rate_tables(client: httpx.Client) -> None:
    post(client, alignment_bytes())
    first = post(client, rate_table_bytes(month=4))
    second = post(client, rate_table_bytes(seed=2, month=5))
    assert (first["is_reference"], second["is_reference"], second["verdict"]) == (True, False, "pass")
    assert [p["u"] < 0.1 * ARCSEC for p in points(client, "gyro x", "misalignment")] == [False, True, True]


def test_a_unit_calibrated_on_a_stand_keeps_its_reference_and_tolerances(client: httpx.Client) -> None:
    post(client, alignment_bytes(unit="BA-017"))
    stand = post(client, session_bytes(month=4))
    later = post(client, session_bytes(seed=2, month=5))
    assert (stand["is_reference"], later["is_reference"], later["verdict"]) == (True, False, "pass")
    decisions = client.get(f"{SESSIONS}/{later['id']}").json()["decisions"]
    assert {d["parameter"] for d in decisions} == {"scale", "bias", "quadratic", "axis"}


@pytest.mark.parametrize("content", [alignment_bytes(), rate_table_bytes()], ids=["alignment", "rate table"])
def test_the_pages_show_them(client: httpx.Client, content: bytes) -> None:
    id = post(client, content)["id"]
    page = client.get(f"/sessions/{id}")
    assert page.status_code == 200
    assert "Misalignment" in page.text
    assert "gyro x" in page.text
    assert "Quadratic term" not in page.text
    unit = client.get("/units/RA-1")
    assert unit.status_code == 200
    assert "Misalignment to the turn axis" in unit.text
    assert client.get("/").status_code == 200


@pytest.mark.parametrize("databases", ENGINES, indirect=True)
@pytest.mark.parametrize("content", [alignment_bytes(), rate_table_bytes()], ids=["alignment", "rate table"])
def test_the_stored_document_is_complete(client: httpx.Client, content: bytes) -> None:
    id = post(client, content)["id"]
    document = client.get(f"{SESSIONS}/{id}/calibration").json()
    assert document["format"] == "imu-calibration/1"
    assert "gyro y.misalignment" in document["covariance"]["names"]
    assert document["fit"]["dof"] > 0
    assert client.get(f"{SESSIONS}/{id}/file").content == content


def test_a_recording_that_cannot_be_used_is_refused_with_its_place(client: httpx.Client) -> None:
    document = json.loads(alignment_bytes())
    document["table"]["turn_angle_deg"] = [0.0] * len(document["table"]["time_s"])
    answer = client.post(SESSIONS, content=json.dumps(document).encode())
    assert answer.status_code == 422
    assert "turn_angle_deg" in answer.json()["problems"][0]["field"]
    assert client.get(SESSIONS).json()["sessions"] == []
