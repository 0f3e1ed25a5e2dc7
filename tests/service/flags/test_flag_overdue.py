"""A unit whose calibration is overdue has one flag, which resolves itself once it is calibrated."""

from datetime import UTC, datetime, timedelta

from service.flags.records import FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.outlook.reading import outlook_of
from service.records.flagging.overdue_units import flag_overdue
from service.storage import Storage
from tests.service.dated import upload_and_date
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 3, 2, tzinfo=UTC)


def states(storage: Storage) -> list[tuple[Matter, FlagState]]:
    with storage.database.reading() as store:
        return [(flag.matter, flag.state) for flag in Flags(store).page(FlagQuery("BA-017"))]


def due_date(storage: Storage) -> datetime | None:
    with storage.database.reading() as store:
        return outlook_of(store, "BA-017", NOW).due


def test_it_is_raised_once_when_the_day_has_passed_and_resolved_by_a_calibration(storage: Storage) -> None:
    upload_and_date(storage, session_bytes(), "a.json", NOW)
    due = due_date(storage)
    assert due is not None
    flag_overdue(storage, due - timedelta(days=1))
    assert states(storage) == []
    for late in (1, 2):
        flag_overdue(storage, due + timedelta(days=late))
    assert states(storage) == [(Matter.OVERDUE, FlagState.RAISED)]
    at = (due + timedelta(days=3)).isoformat()
    upload_and_date(storage, session_bytes(seed=2, started_at=at), "b.json", due + timedelta(days=3))
    assert states(storage) == [(Matter.OVERDUE, FlagState.RESOLVED)]
    flag_overdue(storage, due + timedelta(days=4))
    assert states(storage) == [(Matter.OVERDUE, FlagState.RESOLVED)]


def test_a_unit_that_is_no_longer_due_is_flagged_no_more(storage: Storage) -> None:
    upload_and_date(storage, session_bytes(), "a.json", NOW)
    due = due_date(storage)
    assert due is not None
    flag_overdue(storage, due + timedelta(days=1))
    flag_overdue(storage, due - timedelta(days=1))
    assert states(storage) == [(Matter.OVERDUE, FlagState.RESOLVED)]


def test_a_calibration_that_finds_the_unit_out_of_tolerance_leaves_the_one_flag_open(storage: Storage) -> None:
    upload_and_date(storage, session_bytes(), "a.json", NOW)
    due = due_date(storage)
    assert due is not None
    flag_overdue(storage, due + timedelta(days=1))
    for month, late in enumerate((2, 3)):
        at = due + timedelta(days=late)
        session = session_bytes(seed=2 + month, a3_moved=300.0, started_at=at.isoformat())
        upload_and_date(storage, session, "b.json", at + timedelta(hours=1))
        flag_overdue(storage, at + timedelta(days=1))
    assert [matter for matter, _ in states(storage)].count(Matter.OVERDUE) == 1
