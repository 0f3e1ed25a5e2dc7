"""Each system's file, read back and applied as that system does, gives what the stand applied."""

from collections.abc import Callable

import httpx
import numpy as np
import pytest
import yaml

from estimator import calibrate, read_session
from estimator.applied_vector import stand_geometry
from estimator.correction import correction_of
from estimator.nominal_vector import nominal_vectors
from estimator.session import Array
from tests.builders import Document, accelerometer_block, mixed_block, true_sensors
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import send
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.recordings import recording_bytes

ASKEW = 3e-3
"""rad, one sigma of the axes: what PX4 and ArduPilot leave is some of it."""


def block(tilt: float) -> Document:
    """Three accelerometers whose zeros are off by some 0.05 m/s²."""
    return accelerometer_block(sensors=true_sensors(3, bias=0.05, tilt=tilt), positions=24)


def text(client: httpx.Client, id: str, system: str, **more: str) -> str:
    answer = client.get(f"/api/v1/sessions/{id}/export", params={"system": system, **more})
    assert answer.status_code == 200, answer.text
    return answer.text


def driver(document: Document) -> tuple[Array, Array]:
    """The vectors by the nominal numbers, and those that the stand applied; (R, 3), m/s²."""
    session = read_session(document)
    [one] = correction_of(session, calibrate(session)).blocks
    return nominal_vectors(session, one, session.readings), stand_geometry(session).n[:, 0]


def px4(found: str, raw: Array) -> Array:
    rows = [line.split("\t") for line in found.splitlines() if not line.startswith("#")]
    assert {(row[0], row[1], row[4]) for row in rows} == {("1", "1", "9")}
    values = {row[2]: float(row[3]) for row in rows}
    return (raw - [values[f"CAL_ACC0_{a}OFF"] for a in "XYZ"]) * [values[f"CAL_ACC0_{a}SCALE"] for a in "XYZ"]


def ardupilot(found: str, raw: Array) -> Array:
    values = dict(line.split(",") for line in found.splitlines() if not line.startswith("#"))
    off, scale = ([float(values[f"INS_ACC{name}_{a}"]) for a in "XYZ"] for name in ("OFFS", "SCAL"))
    return (raw - off) * scale


def ros2(found: str, raw: Array) -> Array:
    one = yaml.safe_load(found)["imu_calibration"]["ros__parameters"]["linear_acceleration"]
    assert np.linalg.eigvalsh(np.reshape(one["covariance"], (12, 12))).min() > -1e-18
    return raw @ np.reshape(one["SM"], (3, 3)).T - one["bias"]


def kalibr(found: str, raw: Array) -> Array:
    """The vectors turned back into block axes."""
    imu = yaml.safe_load(found)["imu0"]
    lower = np.array(imu["accelerometers"]["M"])
    assert np.allclose(lower, np.tril(lower), rtol=0, atol=1e-15)
    return np.linalg.solve(lower, (raw - imu["accelerometers"]["b"]).T).T @ np.array(imu["C_imu_block"])


@pytest.mark.parametrize(
    ("system", "applied", "tilt"),
    [("px4", px4, 0.0), ("ardupilot", ardupilot, 0.0), ("ros2", ros2, ASKEW), ("kalibr", kalibr, ASKEW)],
)
def test_a_system_that_uses_its_file_gets_what_the_stand_applied(
    client: httpx.Client, system: str, applied: Callable[[str, Array], Array], tilt: float
) -> None:
    document = block(tilt)
    raw, true = driver(document)
    corrected = applied(text(client, send(client, document), system), raw)
    assert np.abs(raw - true).max() > 0.02
    assert np.abs(corrected - true).max() < 1e-3


def test_a_flight_controller_s_file_says_what_it_leaves(client: httpx.Client) -> None:
    document = block(ASKEW)
    raw, true = driver(document)
    found = text(client, send(client, document), "px4")
    [said] = [line for line in found.splitlines() if "mrad askew" in line]
    left = float(said.split("mrad askew, ")[1].split(" m/s²")[0])
    assert left / 3 < np.abs(px4(found, raw) - true).max() < 3 * left


def test_gyros_go_with_the_accelerometers(client: httpx.Client) -> None:
    id = send(client, mixed_block())
    imu = yaml.safe_load(text(client, id, "kalibr", force="true"))["imu0"]
    rotation = np.array(imu["gyroscopes"]["C_gyro_i"])
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-12)
    assert "CAL_GYRO0_XOFF" in text(client, id, "px4", force="true")
    assert "INS_GYROFFS_Z" in text(client, id, "ardupilot", force="true")
    assert "angular_velocity" in text(client, id, "ros2", force="true")


def test_every_file_says_whose_it_is(client: httpx.Client) -> None:
    id = send(client, block(0.0))
    for system in ("px4", "ardupilot", "kalibr", "ros2"):
        first, second, *_ = text(client, id, system).splitlines()
        assert (first.startswith("# "), "unit BA-" in first, id in second) == (True, True, True)


def test_a_recording_in_service_has_none(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes()).raise_for_status()
    answer = client.post("/api/v1/sessions", content=recording_bytes())
    refused = client.get(f"/api/v1/sessions/{answer.json()['id']}/export", params={"system": "px4"})
    assert (refused.status_code, "no correction" in refused.json()["detail"]) == (404, True)


def test_exchanged_channels_are_refused_where_only_a_scale_can_be_given(client: httpx.Client) -> None:
    document = block(0.0)
    first, second, *_ = document["sensors"]
    first["nominal_axis"], second["nominal_axis"] = second["nominal_axis"], first["nominal_axis"]
    id = send(client, document)
    answer = client.get(f"/api/v1/sessions/{id}/export", params={"system": "px4", "force": "true"})
    assert (answer.status_code, "exchanged" in answer.json()["detail"]) == (409, True)
    assert "SM" in text(client, id, "ros2", force="true")


def test_an_unfit_unit_has_none_unless_it_is_forced_and_then_the_file_says_so(client: httpx.Client) -> None:
    for content in FAILED:
        client.post("/api/v1/sessions", content=content).raise_for_status()
    address = f"/api/v1/sessions/{session_id(FAILED[-1])}/export"
    refused = client.get(address, params={"system": "px4"})
    assert (refused.status_code, "must not be used: A3 bias changed" in refused.json()["detail"]) == (409, True)
    forced = client.get(address, params={"system": "px4", "force": "true"}).raise_for_status().text
    assert "DO NOT USE: ADJUST, REPAIR OR WITHDRAW IT" in forced
    assert "# A3 bias changed" in forced
    assert all(line.startswith("# ") or "CAL_" in line for line in forced.splitlines())


def test_what_is_usable_with_a_reservation_says_it_in_every_file(client: httpx.Client) -> None:
    id = send(client, block(0.0))
    said = client.get("/api/v1/units/BA-017/usable").json()
    assert said["answer"] == "with-reservation"
    for system in ("px4", "ardupilot", "kalibr", "ros2"):
        comments = [line for line in text(client, id, system).splitlines() if line.startswith("# ")]
        assert any("May be used with reservation" in line for line in comments)
        assert {f"# {one}" for one in said["reservations"]} <= set(comments)


def test_a_session_that_was_withdrawn_is_not_handed_on(client: httpx.Client) -> None:
    id = send(client, block(0.0))
    client.post(f"/api/v1/sessions/{id}/withdraw", json={"by": "K. Ito", "why": "wrong unit"}).raise_for_status()
    refused = client.get(f"/api/v1/sessions/{id}/export", params={"system": "px4"})
    assert (refused.status_code, "withdrawn" in refused.json()["detail"]) == (409, True)
