"""A recording in service is compared with its unit's calibration, stored, judged and shown like every session."""

import json
from datetime import UTC, datetime

import httpx
import pytest

from service.errors import RefusedError
from service.records.changes import record_service
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Verdict
from service.sessions.store import Sessions
from service.storage import Storage
from service.units.records import NewService
from service.uploads.receive import upload
from tests.builders import gyro_block
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.estimator.parity.test_gyros import gyros
from tests.estimator.parity.test_gyros import recording as gyro_recording
from tests.service.made_sessions import session_bytes
from tests.service.recordings import recording_bytes, recording_document

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def refusal(storage: Storage, content: bytes) -> str:
    with pytest.raises(RefusedError) as caught:
        upload(storage, content, "flight.json", NOW)
    return "; ".join(map(str, caught.value.problems))


def test_a_recording_of_an_unchanged_unit_passes(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    receipt = upload(storage, recording_bytes(), "flight.json", NOW)
    assert receipt.verdict is Verdict.PASS
    assert receipt.reason.startswith("The sensors agree with one another as at the calibration")


def test_a_drifted_sensor_is_found_and_named(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    receipt = upload(storage, recording_bytes(a3_moved=400.0), "flight.json", NOW)
    assert receipt.verdict is Verdict.FAIL
    assert receipt.reason.startswith("A3 has changed since the calibration: bias +4")
    with storage.database.reading() as store:
        failed = [(d.sensor, d.parameter) for d in Sessions(store).decisions(receipt.id) if d.verdict is Verdict.FAIL]
        stored = Calibrations(store).get(receipt.id)
    assert failed == [("A3", "bias")]
    assert stored.parity is not None
    assert stored.parity["isolated"] == "A3"
    assert stored.sensor("A3").bias.value is not None


def test_what_could_not_have_been_seen_is_undecidable(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    receipt = upload(storage, recording_bytes(seconds=12), "flight.json", NOW)
    assert receipt.verdict is Verdict.UNDECIDABLE
    assert "is detected from" in receipt.reason


def test_a_unit_without_a_calibration_is_told_to_calibrate(storage: Storage) -> None:
    assert "BA-017 has no calibration to compare" in refusal(storage, recording_bytes())


def test_a_service_asks_for_a_new_calibration(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    record_service(storage, "BA-017", NewService("repair", datetime(2026, 4, 1, tzinfo=UTC)), NOW)
    assert "no calibration since its service of 2026-04-01" in refusal(storage, recording_bytes())


def test_a_recording_never_becomes_a_reference(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    id = upload(storage, recording_bytes(), "flight.json", NOW).id
    with storage.database.reading() as store:
        assert not Sessions(store).get(id).is_reference


def test_three_sensors_are_told_that_they_have_no_redundancy(storage: Storage) -> None:
    upload(storage, session_bytes(m=3), "a.json", NOW)
    assert "3 accelerometers leave no redundancy" in refusal(storage, recording_bytes(m=3))


def test_an_unknown_sensor_is_named(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    document = recording_document()
    document["sensors"][5]["name"] = "B6"
    document["table"]["B6"] = document["table"].pop("A6")
    assert "sensors[6].name: B6 is not in the reference calibration" in refusal(storage, json.dumps(document).encode())


def test_a_saturated_channel_is_named(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    document = recording_document()
    document["table"]["A2"] = [min(u, -0.5) for u in document["table"]["A2"]]
    assert "A2: A2 was at the end of the range" in refusal(storage, json.dumps(document).encode())


def test_over_http_its_page_and_answers_are_served(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes())
    answer = client.post("/api/v1/sessions", content=recording_bytes(a3_moved=400.0))
    assert (answer.status_code, answer.json()["verdict"]) == (201, "fail")
    id = answer.json()["id"]
    assert client.get(f"/api/v1/sessions/{id}/calibration").json()["parity"]["isolated"] == "A3"
    assert "A3 has changed since the calibration" in client.get(f"/sessions/{id}").text
    history = client.get("/api/v1/units/BA-017/history", params={"parameter": "bias", "sensor": "A3"}).json()
    assert [p["verdict"] for p in history["points"]][-1] == "fail"
    assert client.get("/units/BA-017").status_code == 200


def test_the_reference_is_that_of_the_epoch(storage: Storage) -> None:
    upload(storage, session_bytes(month=3), "a.json", NOW)
    record_service(storage, "BA-017", NewService("repair", datetime(2026, 6, 1, tzinfo=UTC)), NOW)
    upload(storage, session_bytes(month=7, a3_moved=500.0, seed=2), "b.json", NOW)
    assert upload(storage, recording_bytes(), "flight.json", NOW).verdict is Verdict.PASS


def test_a_gyro_block_is_judged_in_its_own_units(storage: Storage) -> None:
    calibration = gyro_block(sensors=gyros()) | {"started_at": "2026-03-01T09:00:00Z"}
    upload(storage, json.dumps(calibration).encode(), "a.json", NOW)
    assert upload(storage, json.dumps(gyro_recording()).encode(), "f.json", NOW).verdict is not Verdict.FAIL
    moved = gyro_recording(2.0) | {"started_at": "2026-09-01T09:00:00Z"}
    receipt = upload(storage, json.dumps(moved).encode(), "g.json", NOW)
    assert (receipt.verdict, receipt.reason[:53]) == (
        Verdict.FAIL,
        "G3 has changed since the calibration: bias +2.0 °/h (",
    )


def test_pulses_without_their_count_time_are_refused(storage: Storage) -> None:
    document = gyro_recording()
    del document["count_time_s"]
    assert "count_time_s: missing; gyro readings are pulses" in refusal(storage, json.dumps(document).encode())
