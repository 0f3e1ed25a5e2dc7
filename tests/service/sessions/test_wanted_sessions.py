"""Sessions that a list holds, their order, and reading on from one of them."""

from dataclasses import replace
from datetime import UTC, datetime
from itertools import product

import pytest

from service.records.changes import withdraw_session
from service.sessions.decision import Verdict
from service.sessions.records import SessionOrder, SessionQuery
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.storage import Storage
from service.uploads.receive import upload
from tests.conftest import Filled
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.made_records import step, way
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
STAND = {"id": "S-2", "alpha_deg": 40.0, "sigma_arcsec": dict.fromkeys(("theta_x", "theta_y", "alpha", "beta"), 0.3)}
ALL = SessionQuery()
SESSIONS = {"C": (1, 4, 6), "A": (2, 5), "B": (3,)}
"""Months of 2026 in which each unit was measured; C is unfit in April, withdrawn in June, B was on another stand."""


def six_sessions(storage: Storage) -> None:
    """Uploaded unit by unit."""
    for unit, months in SESSIONS.items():
        for month in months:
            moved = 200.0 if (unit, month) == ("C", 4) else 0.0
            other = {"stand": STAND, "unit_type": "RB"} if unit == "B" else {"unit_type": "RA"}
            content = session_bytes(seed=month, month=month, unit=unit, a3_moved=moved, **other)
            upload(storage, content, "a.json", NOW)
    withdraw_session(storage, way(storage), id_of(storage, 6), step())


@pytest.fixture
def stored(filled: Filled) -> Storage:
    return filled(six_sessions)


def listed(stored: Storage, wanted: SessionQuery) -> str:
    """The months."""
    with stored.database.reading() as store:
        return "".join(str(found.started_at.month) for found in Sessions(store).wanted(wanted))


def id_of(stored: Storage, month: int) -> str:
    with stored.database.reading() as store:
        return next(s.id for s in Sessions(store).wanted(ALL) if s.started_at.month == month)


def test_sessions_are_listed_in_the_order_asked_for(stored: Storage) -> None:
    for order, months in ((SessionOrder.MEASURED, "654321"), (SessionOrder.UNIT, "253146")):
        assert listed(stored, replace(ALL, order=order)) == months
        assert listed(stored, replace(ALL, order=order, backwards=True)) == months[::-1]
    assert listed(stored, replace(ALL, order=SessionOrder.VERDICT, limit=1)) == "4"


NARROWED: tuple[tuple[dict[str, object], str], ...] = (
    ({"text": "c"}, "641"),
    ({"unit_type": "RA"}, "65421"),
    ({"unit_type": "RX"}, ""),
    ({"stand": "S-2"}, "3"),
    ({"since": datetime(2026, 3, 1, 9, tzinfo=UTC)}, "6543"),
    ({"until": datetime(2026, 3, 1, 9, tzinfo=UTC)}, "21"),
    ({"state": RecordState.WITHDRAWN}, "6"),
    ({"state": RecordState.ACCEPTED}, "54321"),
    ({"verdict": Verdict.FAIL}, "4"),
    ({"is_reference": True}, "321"),
    ({"reserved": True}, ""),
)


def test_a_list_is_narrowed(stored: Storage) -> None:
    found = [(wanted, listed(stored, replace(ALL, **wanted))) for wanted, _ in NARROWED]
    assert found == list(NARROWED)


def test_a_list_read_on_in_both_directions_is_the_whole_list(stored: Storage) -> None:
    for order, backwards in product(SessionOrder, (False, True)):
        query = replace(ALL, order=order, backwards=backwards)
        whole = listed(stored, query)
        after = listed(stored, replace(query, after=id_of(stored, int(whole[1])), limit=2))
        before = listed(stored, replace(query, before=id_of(stored, int(whole[4])), limit=2))
        assert (after, before) == (whole[2:4], whole[2:4]), (order, backwards)


def test_a_session_that_is_not_there_begins_the_list_anew(stored: Storage) -> None:
    for place in ({"after": "none"}, {"before": "none"}):
        assert listed(stored, replace(ALL, limit=2, **place)) == "65"
