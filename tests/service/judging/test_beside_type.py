"""A first session unlike all other units of its type is questioned; what a unit does later its tolerances judge."""

from collections.abc import Callable

import pytest

from service.judging.beside_type import FEWEST
from service.kit.metrics import Metrics
from service.records.reception import Reception
from service.sessions.states import RecordState
from service.storage import Storage
from service.uploads.correct import correct_session
from service.uploads.receive import upload
from tests.builders import Document
from tests.conftest import Filled
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_records import NOW
from tests.service.made_sessions import session_bytes
from tests.service.uploads.test_questioned import slipped, times

TYPE = "BA-6"


def fill(storage: Storage) -> None:
    """Stores as many units of one type as show what is usual."""
    for number in range(FEWEST):
        upload(
            storage, session_bytes(unit_type=TYPE, unit=f"OK-{number}", seed=20 + number), "a.json", NOW, outlook=False
        )


@pytest.fixture
def fleet(filled: Filled) -> Storage:
    return filled(fill)


def in_mv(document: Document) -> None:
    """Readings and nominal values alike, declared V."""
    times(1000.0)(document)
    for sensor in document["sensors"]:
        sensor["nominal_scale"] *= 1000


def renamed(document: Document) -> None:
    """The channels of A1 and A2 with their nominal axes under one another's name."""
    table, (first, second, *_) = document["table"], document["sensors"]
    for end in ("", "_se"):
        table[f"A1{end}"], table[f"A2{end}"] = table[f"A2{end}"], table[f"A1{end}"]
    first["nominal_axis"], second["nominal_axis"] = second["nominal_axis"], first["nominal_axis"]


def uncertain(document: Document) -> None:
    """Standard errors of readings in mV, where the readings are in V."""
    for sensor in document["sensors"]:
        column = f"{sensor['name']}_se"
        document["table"][column] = [error * 1000 for error in document["table"][column]]


SLIPS: dict[str, tuple[Callable[[Document], None], str]] = {
    "unit": (in_mv, "Every scale factor is 1000 times its value in the type's other units"),
    "names": (renamed, "away from its direction in the other units of the type, along the axis of A2"),
    "errors": (uncertain, "times less certain than in the other units of the type"),
}


@pytest.mark.parametrize("name", SLIPS)
def test_what_only_the_type_can_tell_is_questioned(fleet: Storage, name: str) -> None:
    slip, words = SLIPS[name]
    receipt = upload(fleet, slipped(slip, unit_type=TYPE, unit="NEW-1", seed=40), "a.json", NOW)
    assert (receipt.state, receipt.is_reference) == (RecordState.QUESTIONED, False)
    assert words in receipt.reason


def test_a_zero_that_no_unit_of_the_type_has_is_questioned_before_it_is_a_reference(fleet: Storage) -> None:
    receipt = upload(fleet, session_bytes(unit_type=TYPE, unit="NEW-2", seed=41, a3_moved=9000.0), "a.json", NOW)
    assert receipt.state is RecordState.QUESTIONED
    assert "The bias of A3 differs by" in receipt.reason
    moved = session_bytes(unit_type=TYPE, unit="OK-1", seed=42, month=5, a3_moved=9000.0)
    assert upload(fleet, moved, "a.json", NOW).state is RecordState.ACCEPTED


def test_a_unit_like_the_others_is_not_asked(fleet: Storage) -> None:
    assert upload(fleet, session_bytes(unit_type=TYPE, unit="NEW-3", seed=43), "a.json", NOW).is_reference


def test_readings_and_nominal_values_are_put_right_together(fleet: Storage) -> None:
    asked = upload(fleet, slipped(in_mv, unit_type=TYPE, unit="NEW-4", seed=44), "a.json", NOW)
    made = correct_session(Reception(fleet, 2.0, Metrics(), lambda: None), asked.id, "K. Ito", NOW)
    assert (made.state, made.is_reference) == (RecordState.ACCEPTED, True)


def test_units_of_another_design_whose_type_nobody_named_are_not_held_against_one_another(storage: Storage) -> None:
    """They are all called after what their files describe, six accelerometers in volts."""
    for number in range(FEWEST):
        upload(storage, session_bytes(unit=f"OK-{number}", seed=20 + number), "a.json", NOW, outlook=False)
    assert upload(storage, slipped(in_mv, unit="NEW-4", seed=44), "a.json", NOW).is_reference
    moved = session_bytes(unit="NEW-5", seed=45, a3_moved=9000.0)
    assert upload(storage, moved, "a.json", NOW).state is RecordState.QUESTIONED
