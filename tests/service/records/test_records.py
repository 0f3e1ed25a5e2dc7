"""Records are accepted, withdrawn, superseded, and what is known of a unit follows."""

import json
from datetime import UTC, datetime

import pytest
from sqlalchemy import text
from sqlalchemy.exc import DatabaseError

from service.errors import ConflictError, NotFoundError
from service.flags.store import Flags
from service.fleet.store import Fleet
from service.outlook.store import Outlooks
from service.records.changes import accept_session, choose_reference, record_service, withdraw_service, withdraw_session
from service.records.supersede import supersede_session
from service.sessions.decision import Verdict
from service.sessions.records import Receipt, StoredSession
from service.sessions.sent import Replaced, Stated
from service.sessions.states import RecordKind, RecordState
from service.sessions.states_store import States
from service.sessions.store import Sessions
from service.storage import Storage
from service.units.records import NewService
from service.units.store import Units
from tests.estimator.test_reading_csv import csv_of
from tests.service.dated import upload_and_date as upload
from tests.service.made_records import NOW, state_of, step, way
from tests.service.made_sessions import session_bytes

UNIT = "BA-017"
APRIL = datetime(2026, 4, 1, tzinfo=UTC)


def measured(storage: Storage, month: int, moved: float = 0.0, replaces: Replaced | None = None) -> Receipt:
    """A session of a month with A3's bias moved by so many µg."""
    content = session_bytes(seed=month, month=month, a3_moved=moved)
    return upload(storage, content, f"{month}.json", NOW, stated=Stated(replaces=replaces))


def stored(storage: Storage, id: str) -> StoredSession:
    with storage.database.reading() as store:
        return Sessions(store).get(id)


def references(storage: Storage) -> list[int]:
    """Months of the reference sessions."""
    with storage.database.reading() as store:
        return [s.started_at.month for s in Sessions(store).of_unit(UNIT) if s.is_reference]


def test_a_service_entered_after_its_as_left_session_takes_the_fail_back(storage: Storage) -> None:
    measured(storage, 3)
    left = measured(storage, 5, 300.0)
    assert left.verdict is Verdict.FAIL
    record_service(storage, UNIT, NewService("repair", APRIL), NOW)
    assert stored(storage, left.id).is_reference
    with storage.database.reading() as store:
        assert Sessions(store).decisions(left.id) == () or stored(storage, left.id).verdict is Verdict.UNDECIDABLE
        outlook = Outlooks(store).of_unit(UNIT)
    assert outlook is not None
    assert outlook.due == datetime(2027, 5, 1, 9, tzinfo=UTC)


def test_an_older_session_becomes_the_reference_whenever_it_comes_in(storage: Storage) -> None:
    measured(storage, 5)
    later = measured(storage, 6, 90.0)
    assert measured(storage, 3, 90.0).is_reference
    assert references(storage) == [3]
    assert stored(storage, later.id).verdict is Verdict.PASS


def test_a_corrected_file_stands_for_the_first_and_counts_once(storage: Storage) -> None:
    measured(storage, 3)
    wrong = measured(storage, 5, 300.0)
    content = session_bytes(seed=5, month=5)
    right = upload(
        storage, content, "b.json", NOW, stated=Stated(replaces=Replaced(wrong.id, "K. Ito", "typing error"))
    )
    known = stored(storage, wrong.id)
    assert (known.state, known.superseded_by) == (RecordState.SUPERSEDED, right.id)
    with storage.database.reading() as store:
        condition = Fleet(store).unit(UNIT)
    assert condition is not None
    assert (condition.sessions, condition.verdict) == (2, Verdict.PASS)


def test_a_session_moves_to_another_unit_by_a_corrected_file(storage: Storage) -> None:
    measured(storage, 3)
    before = state_of(storage, UNIT)
    wrong = measured(storage, 5, 300.0)
    right = session_bytes(seed=5, month=5, a3_moved=300.0, unit="BA-018")
    assert upload(
        storage, right, "b.json", NOW, stated=Stated(replaces=Replaced(wrong.id, "K. Ito", "other unit"))
    ).is_reference
    assert state_of(storage, UNIT)[UNIT] == before[UNIT]


def test_the_same_content_in_another_format_is_the_same_session(storage: Storage) -> None:
    document = json.loads(session_bytes())
    first = upload(storage, json.dumps(document).encode(), "a.json", NOW)
    again = upload(storage, csv_of(document), "a.csv", NOW)
    assert (again.id, again.created) == (first.id, False)


@pytest.mark.slow
def test_a_clock_of_1970_moves_nothing_unless_an_engineer_accepts_it(storage: Storage) -> None:
    for month in (3, 4, 5):
        measured(storage, month, 5.0 * month)
    before = state_of(storage, UNIT)
    wrong = upload(storage, session_bytes(seed=9, started_at="1970-01-01T00:00:00Z"), "c.json", NOW)
    assert (wrong.state, wrong.reason.split(":")[0]) == (RecordState.QUESTIONED, "Questioned, not judged")
    assert state_of(storage, UNIT) == before
    accept_session(storage, way(storage), wrong.id, step("it was so"))
    assert state_of(storage, UNIT) != before
    withdraw_session(storage, way(storage), wrong.id, step("the clock had stopped"))
    assert state_of(storage, UNIT) == before


def test_a_withdrawn_session_says_by_whom_and_why_and_comes_back_as_it_was(storage: Storage) -> None:
    measured(storage, 3)
    id = measured(storage, 5, 90.0).id
    before = state_of(storage, UNIT)
    withdraw_session(storage, way(storage), id, step("cable"))
    with storage.database.reading() as store:
        [line] = States(store).of(RecordKind.SESSION, id)
    assert (line.state, line.who, line.why, line.at) == (RecordState.WITHDRAWN, "K. Ito", "cable", NOW)
    accept_session(storage, way(storage), id, step("it was not the cable"))
    assert state_of(storage, UNIT) == before


def test_a_unit_without_an_accepted_session_is_in_no_fleet_and_still_there(storage: Storage) -> None:
    id = measured(storage, 3).id
    withdraw_session(storage, way(storage), id, step())
    with storage.database.reading() as store:
        assert Fleet(store).condition().units == 0
        unit = Fleet(store).unit(UNIT)
        assert unit is not None
        assert (unit.verdict, unit.sessions) == (None, 0)
        assert Outlooks(store).of_unit(UNIT) is None


def test_a_withdrawn_service_is_no_break_and_counts_again_once_it_is_recorded_again(storage: Storage) -> None:
    measured(storage, 3)
    measured(storage, 5, 300.0)
    service, _ = record_service(storage, UNIT, NewService("repair", APRIL), NOW)
    after = state_of(storage, UNIT)
    withdrawn, _ = withdraw_service(storage, way(storage), service.id, step())
    assert (withdrawn.state, references(storage)) == (RecordState.WITHDRAWN, [3])
    again, derived = record_service(storage, UNIT, NewService("repair", APRIL), NOW)
    assert (again.id, derived is not None) == (service.id, True)
    assert state_of(storage, UNIT) == after


def test_an_engineer_chooses_the_reference_and_all_of_the_epoch_are_judged_against_it(storage: Storage) -> None:
    first = measured(storage, 3, 300.0)
    second = measured(storage, 4)
    measured(storage, 5)
    choose_reference(storage, way(storage), second.id, step("the first was measured warm"))
    assert references(storage) == [4]
    assert stored(storage, first.id).verdict is Verdict.FAIL
    withdraw_session(storage, way(storage), second.id, step())
    assert references(storage) == [3]
    accept_session(storage, way(storage), second.id, step())
    assert references(storage) == [4]


def test_a_flag_goes_with_the_session_that_raised_it(storage: Storage) -> None:
    measured(storage, 3)
    id = measured(storage, 5, 90.0).id
    withdraw_session(storage, way(storage), id, step())
    with storage.database.reading() as store:
        assert Flags(store).open_of(Units(store).key(UNIT)) == ()


def test_what_does_not_fit_the_state_is_refused(storage: Storage) -> None:
    first, second = measured(storage, 3).id, measured(storage, 5).id
    own = way(storage)
    with pytest.raises(ConflictError, match="accepted already"):
        accept_session(storage, own, first, step())
    supersede_session(storage, own, Replaced(first, "K. Ito", "typing error"), second)
    for act in (withdraw_session, choose_reference):
        with pytest.raises(ConflictError, match="superseded"):
            act(storage, own, first, step())
    with pytest.raises(ConflictError, match="replaces session"):
        accept_session(storage, own, first, step())
    with pytest.raises(NotFoundError):
        withdraw_service(storage, own, 99, step())


@pytest.mark.parametrize("table", ["record_states", "reference_choices"])
def test_the_database_refuses_to_change_what_became_of_a_record(storage: Storage, table: str) -> None:
    id = measured(storage, 3).id
    choose_reference(storage, way(storage), id, step())
    withdraw_session(storage, way(storage), id, step())
    with pytest.raises(DatabaseError, match="append-only"), storage.database.engine.begin() as connection:
        connection.execute(text(f"UPDATE {table} SET who = 'x'"))
