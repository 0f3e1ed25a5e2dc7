"""Units that a list holds, and their order."""

from collections import Counter
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest

from service.fleet.records import FleetChoices, FleetQuery, Order, UseAt
from service.fleet.store import Fleet
from service.fleet.use import Use
from service.fleet.uses_store import Uses
from service.judging.usable_reading import usable_of
from service.records.unit_changes import set_lot
from service.storage import Storage
from tests.conftest import Filled
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.dated import upload_and_date
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
STAND = {"id": "S-2", "alpha_deg": 40.0, "sigma_arcsec": dict.fromkeys(("theta_x", "theta_y", "alpha", "beta"), 0.3)}
ALL = FleetQuery()


def three_units(storage: Storage) -> None:
    """C-1 is unfit since April, A-1 fit since February, B-1 measured once, in March, on another stand."""
    for unit, month, moved in (("C-1", 1, 0.0), ("C-1", 4, 200.0), ("A-1", 1, 0.0), ("A-1", 2, 0.0)):
        upload_and_date(storage, session_bytes(seed=month, month=month, unit=unit, a3_moved=moved), "a.json", NOW)
    upload_and_date(storage, session_bytes(month=3, unit="B-1", stand=STAND), "b.json", NOW)
    set_lot(storage, "A-1", "L7", NOW, who="K. Ito")


@pytest.fixture
def fleet(filled: Filled) -> Storage:
    return filled(three_units)


def listed(fleet: Storage, wanted: FleetQuery) -> str:
    """The letters of the serial numbers."""
    with fleet.database.reading() as store:
        return "".join(unit.serial[0] for unit in Fleet(store).units(wanted))


@pytest.mark.parametrize(
    ("order", "letters"),
    [(Order.CONDITION, "CBA"), (Order.SERIAL, "ABC"), (Order.LAST, "ABC"), (Order.DUE, "CAB"), (Order.TYPE, "ABC")],
)
def test_units_are_listed_in_the_order_asked_for(fleet: Storage, order: Order, letters: str) -> None:
    assert listed(fleet, replace(ALL, order=order)) == letters
    backwards = listed(fleet, replace(ALL, order=order, backwards=True))
    assert backwards == (letters if order is Order.TYPE else letters[::-1])


@pytest.mark.parametrize(
    ("wanted", "letters"),
    [
        ({"stand": "S-2"}, "B"),
        ({"stand": "S-3"}, ""),
        ({"lot": "L7"}, "A"),
        ({"flagged": True}, "C"),
        ({"undated": True}, "C"),
        ({"due_before": datetime(2027, 2, 15, tzinfo=UTC)}, "A"),
        ({"due_before": NOW + timedelta(days=900)}, "AB"),
        ({"unit_type": "RA-7"}, ""),
    ],
)
def test_a_list_is_narrowed(fleet: Storage, wanted: dict[str, object], letters: str) -> None:
    assert listed(fleet, replace(ALL, order=Order.SERIAL, **wanted)) == letters


def test_what_a_list_can_be_narrowed_to(fleet: Storage) -> None:
    with fleet.database.reading() as store:
        found = Fleet(store).choices()
    assert found == FleetChoices(types=found.types, stands=("ODG-1", "S-2"), lots=("L7",))
    assert len(found.types) == 1


@pytest.mark.parametrize("order", Order)
@pytest.mark.parametrize("backwards", [False, True])
def test_a_list_read_on_from_unit_to_unit_is_the_whole_list(fleet: Storage, order: Order, backwards: bool) -> None:
    wanted = FleetQuery(order=order, backwards=backwards)
    whole, read = listed(fleet, wanted), ""
    names = {"A": "A-1", "B": "B-1", "C": "C-1"}
    while len(read) < len(whole):
        read += listed(fleet, replace(wanted, after=names[read[-1]] if read else None, limit=1))
    assert read == whole
    assert listed(fleet, replace(wanted, before=names[whole[-1]], limit=1)) == whole[-2]
    assert listed(fleet, replace(wanted, after=names[whole[-1]])) == ""


def test_the_clock_forbids_what_is_stored_as_usable(fleet: Storage) -> None:
    """A-1 falls due in February 2027; before its session of February 2026 that one is dated in the future."""
    for now in (datetime(2026, 1, 15, tzinfo=UTC), NOW, datetime(2027, 6, 1, tzinfo=UTC)):
        with fleet.database.reading() as store:
            units = Fleet(store).units(ALL)
            answered = Counter(use.answer for use in usable_of(store, units, now).values())
            assert +Uses(store).at(now) == answered
            for use in Use:
                found = Fleet(store).units(replace(ALL, use=UseAt(use, now)))
                assert len(found) == answered[use]
