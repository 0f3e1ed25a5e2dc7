"""A file that cannot be right is questioned, the likely slip is named, and an engineer may accept it still."""

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmarks.hands.world import World, simulated
from estimator import calibrate, read_session
from estimator.writing import session_document
from service.errors import ConflictError
from service.kit.metrics import Metrics
from service.records.changes import OTHERWISE_WRITTEN, accept_session
from service.records.diagnose import diagnose
from service.records.reception import Reception
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Verdict
from service.sessions.records import Receipt
from service.sessions.states import RecordKind, RecordState
from service.sessions.states_store import States
from service.sessions.store import Sessions
from service.storage import Storage
from service.uploads.correct import correct_session
from service.uploads.receive import upload
from tests.builders import accelerometer_block, true_sensors
from tests.service.made_records import NOW, state_of, step, way
from tests.service.made_sessions import session_bytes


@pytest.fixture
def reception(storage: Storage) -> Reception:
    """Diagnoses are left for later."""
    return Reception(storage, 2.0, Metrics(), lambda: None)


Slip = Callable[[dict[str, Any]], None]
A1, A2 = "A1", "A2"


def slipped(slip: Slip, **given: Any) -> bytes:
    """A session file with a slip."""
    document = json.loads(session_bytes(**given))
    slip(document)
    return json.dumps(document).encode()


def times(factor: float, *names: str) -> Slip:
    """Readings of some sensors, of all without names, times a factor."""

    def slip(document: dict[str, Any]) -> None:
        table = document["table"]
        for name in names or [sensor["name"] for sensor in document["sensors"]]:
            table[name] = [factor * reading for reading in table[name]]
            table[f"{name}_se"] = [abs(factor) * error for error in table[f"{name}_se"]]

    return slip


def exchanged(document: dict[str, Any]) -> None:
    table = document["table"]
    table[A1], table[A2] = table[A2], table[A1]


def per_g(document: dict[str, Any]) -> None:
    for sensor in document["sensors"]:
        sensor["nominal_scale"] *= 9.80665


def noisy(document: dict[str, Any]) -> None:
    for sensor in document["sensors"]:
        document["table"][f"{sensor['name']}_se"] = [200 * error for error in document["table"][f"{sensor['name']}_se"]]


SWAPPED = accelerometer_block(6, seed=3, unit="BA-017", sensors=true_sensors(6, bias=1e-3, tilt=1e-4), positions=24)
"""A session with both runs under one another's name."""
SLIPS: dict[str, tuple[Slip, str]] = {
    "mV for V": (times(1000.0), "such as mV instead of V"),
    "one channel in mV": (times(1000.0, A1), "The scale factor of A1 is 1"),
    "per g": (per_g, "g and m/s² were confused"),
    "degrees": (times(57.2958), "degrees instead of radians"),
    "sign": (times(-1.0, A1), "its sign is reversed"),
    "exchange": (exchanged, "their channels are exchanged"),
    "noise": (noisy, "times less than their standard errors: another unit is stated"),
}


@pytest.mark.parametrize("name", SLIPS)
def test_a_slip_is_named_and_makes_neither_reference_nor_verdict(storage: Storage, name: str) -> None:
    slip, words = SLIPS[name]
    receipt = upload(storage, slipped(slip), "a.json", NOW)
    assert words in receipt.reason
    assert (receipt.state, receipt.verdict, receipt.is_reference) == (
        RecordState.QUESTIONED,
        Verdict.UNDECIDABLE,
        False,
    )
    assert state_of(storage, "BA-017")["BA-017"]["sessions"] == []


@pytest.mark.parametrize(
    ("hand", "words"),
    [
        (World(units=57.2958), "The scale factor of G1, G2, G3 is"),
        (World(units=57.2958), "degrees instead of radians"),
        (World(signs=(1.0, -1.0, 1.0)), "G2 has the wrong sign"),
    ],
)
def test_gyros_turned_by_hand_tell_degrees_from_radians_and_a_lost_sign(
    storage: Storage, hand: World, words: str
) -> None:
    truth = simulated(replace(hand, rests=14, rest=2.5, rate=50.0), np.random.default_rng(1))
    document = session_document(replace(truth.session, started_at="2026-03-01T09:00:00Z"))
    receipt = upload(storage, json.dumps(document).encode(), "hand.json", NOW)
    assert (receipt.state, words in receipt.reason) == (RecordState.QUESTIONED, True)


def test_readings_and_nominal_in_another_unit_than_the_units_history_are_questioned(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)

    def in_mv(document: dict[str, Any]) -> None:
        times(1000.0)(document)
        for sensor in document["sensors"]:
            sensor["nominal_scale"] *= 1000

    assert "1000 times its value at the unit's reference" in later(storage, in_mv).reason


def later(storage: Storage, slip: Slip) -> Receipt:
    return upload(storage, slipped(slip, seed=2, month=5), "b.json", NOW)


def test_an_engineer_accepts_what_was_questioned_and_it_is_judged(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    questioned = later(storage, times(1000.0))
    session, _ = accept_session(storage, way(storage), questioned.id, step("it is so"))
    assert session.state is RecordState.ACCEPTED
    assert "Questioned" in questioned.reason
    assert "Questioned" not in session.reason


def runs_swapped() -> bytes:
    document = json.loads(json.dumps(SWAPPED))
    document["table"]["run"] = ["flipped" if run == "direct" else "direct" for run in document["table"]["run"]]
    return json.dumps(document).encode()


def test_a_diagnosis_that_says_it_was_done_otherwise_questions_the_session_once(storage: Storage) -> None:
    id = upload(storage, runs_swapped(), "a.json", NOW).id
    found = diagnose(storage, id, NOW).found
    assert found is not None
    assert {finding.cause for finding in found.findings} & set(OTHERWISE_WRITTEN)
    assert states(storage, id) == [RecordState.QUESTIONED]
    accept_session(storage, way(storage), id, step("it was so"))
    assert states(storage, id) == [RecordState.QUESTIONED, RecordState.ACCEPTED]


def states(storage: Storage, id: str) -> list[RecordState]:
    with storage.database.reading() as store:
        return [line.state for line in States(store).of(RecordKind.SESSION, id)]


@pytest.mark.parametrize("date", ["1970-01-01T00:00:00Z", "2000-01-03T00:00:00Z", "2006-05-01T00:00:00Z"])
def test_a_date_before_the_unit_existed_is_questioned(storage: Storage, date: str) -> None:
    """2006: a GPS receiver whose weeks began anew."""
    upload(storage, session_bytes(), "a.json", NOW)
    receipt = upload(storage, session_bytes(seed=2, started_at=date), "b.json", NOW)
    assert (receipt.state, "the clock was wrong" in receipt.reason) == (RecordState.QUESTIONED, True)


def test_a_unit_that_is_merely_out_of_tolerance_is_judged(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    receipt = upload(storage, session_bytes(seed=2, month=5, a3_moved=5000.0), "b.json", NOW)
    assert (receipt.state, receipt.verdict) == (RecordState.ACCEPTED, Verdict.FAIL)


@pytest.mark.parametrize("slip", ["mV for V", "one channel in mV", "per g", "sign", "exchange"])
def test_a_corrected_file_is_made_and_stands_for_the_questioned_one(reception: Reception, slip: str) -> None:
    right = calibrate(read_session(json.loads(session_bytes())))
    asked = upload(reception.storage, slipped(SLIPS[slip][0]), "slip.json", NOW)
    made = correct_session(reception, asked.id, "K. Ito", NOW)
    assert (made.state, made.is_reference) == (RecordState.ACCEPTED, True)
    with reception.storage.database.reading() as store:
        assert Sessions(store).get(asked.id).superseded_by == made.id
        assert "Corrected: " in Sessions(store).get(made.id).notes
        scales = [[s.scale.value for s in one.sensors] for one in (Calibrations(store).get(made.id), right)]
    assert scales[0] == pytest.approx(scales[1], rel=1e-9)


def test_what_is_not_questioned_is_not_corrected(reception: Reception) -> None:
    with pytest.raises(ConflictError, match="not questioned"):
        correct_session(reception, upload(reception.storage, session_bytes(), "right.json", NOW).id, "K. Ito", NOW)


def test_where_no_correction_is_known_that_is_said(reception: Reception) -> None:
    document = json.loads(session_bytes()) | {"started_at": "1970-01-01T00:00:00Z"}
    asked = upload(reception.storage, json.dumps(document).encode(), "old.json", NOW)
    with pytest.raises(ConflictError, match="No correction is known"):
        correct_session(reception, asked.id, "K. Ito", NOW)
