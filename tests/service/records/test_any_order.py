"""The state of a unit is a function of its accepted records, in whatever order and by whatever detour they came."""

import json
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from service.opening import open_database
from service.records.changes import accept_session, choose_reference, record_service, withdraw_service, withdraw_session
from service.sessions.sent import Replaced, Stated
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.storage import Files, Storage
from service.units.records import NewService
from tests.databases import Databases
from tests.estimator.test_reading_csv import csv_of
from tests.service.dated import upload_and_date
from tests.service.made_records import NOW, state_of, step, way
from tests.service.made_sessions import session_bytes, session_id

UNITS = ("BA-017", "BA-018")
SERVICE = NewService("repair", datetime(2026, 4, 15, tzinfo=UTC), "shock", "K. Ito")
MOVED = {1: 0.0, 2: 52.0, 3: 90.0, 4: 10.0, 5: 200.0, 6: 205.0, 7: 280.0}
"""Change of A3's bias in µg by month: fails before the service, and again after it."""
WRONG = session_bytes(seed=6, month=6, a3_moved=700.0, unit=UNITS[1])
"""Uploaded under another unit's name, and for a bias that was none; the session of June stands for it."""


@cache
def content(month: int) -> bytes:
    """The session of a month."""
    return session_bytes(seed=month, month=month, a3_moved=MOVED[month])


@dataclass
class Crew:
    """Brings records into a service, in its own order and with its own detours."""

    storage: Storage
    services: list[int] = field(default_factory=list)

    def brings(self, month: int, detour: str) -> None:
        """A session, perhaps taken back and accepted again, or sent twice in two formats."""
        id = session_id(content(month))
        if month == 6 and detour == "corrected":
            wrong = upload_and_date(self.storage, WRONG, "wrong.json", NOW).id
            stated = Stated(replaces=Replaced(wrong, "K. Ito", "other unit"))
            upload_and_date(self.storage, content(6), "a.json", NOW, stated=stated)
            return
        upload_and_date(self.storage, content(month), "a.json", NOW)
        if detour == "twice":
            upload_and_date(self.storage, csv_of(json.loads(content(month))), "a.csv", NOW)
        if detour == "chosen" and month < SERVICE.at.month:
            self.chosen(id)
        if detour == "withdrawn":
            withdraw_session(self.storage, way(self.storage), id, step())

    def chosen(self, id: str) -> None:
        """A reference that somebody chooses and another one chooses otherwise later."""
        choose_reference(self.storage, way(self.storage), id, step())

    def serves(self, detour: str) -> None:
        """The unit's service, perhaps entered under a wrong date first."""
        if detour == "withdrawn":
            wrong = NewService("repair", datetime(2026, 2, 15, tzinfo=UTC), "shock", "K. Ito")
            service, _ = record_service(self.storage, UNITS[0], wrong, NOW)
            withdraw_service(self.storage, way(self.storage), service.id, step())
        record_service(self.storage, UNITS[0], SERVICE, NOW)

    def mends(self) -> None:
        """Accepts again everything that was taken back, and chooses one reference before the service that all agree
        on.
        """
        with self.storage.database.reading() as store:
            gone = [s.id for s in Sessions(store).of_unit(UNITS[0]) if s.state is RecordState.WITHDRAWN]
        for id in gone:
            accept_session(self.storage, way(self.storage), id, step())
        self.chosen(session_id(content(2)))


DETOURS = st.sampled_from(["none", "none", "twice", "withdrawn", "chosen", "corrected"])
ORDERS = st.permutations([*MOVED, "service"]).flatmap(
    lambda order: st.tuples(*(st.tuples(st.just(record), DETOURS) for record in order))
)


def known(databases: Databases, folder: Path, order: Any) -> dict[str, Any]:
    """The state after an order of arrivals."""
    with ExitStack() as stack:
        url = databases.migrated()
        stack.callback(databases.drop, url)
        database = open_database(url)
        stack.callback(database.close)
        crew = Crew(Storage(database, Files(folder)))
        first = min(i for i, (record, _) in enumerate(order) if record != "service")
        order = (order[first], *order[:first], *order[first + 1 :])  # a service is recorded of a known unit only
        for record, detour in order:
            if record == "service":
                crew.serves(detour)
            else:
                crew.brings(record, detour)
        crew.mends()
        found = state_of(crew.storage, UNITS[0])
        stack.close()
    return found


IN_ORDER = tuple((record, "none") for record in (1, 2, 3, 4, "service", 5, 6, 7))


def _holds(databases: Databases, folder: Path, examples: int) -> Callable[[], None]:
    expected = known(databases, folder, IN_ORDER)

    @settings(max_examples=examples, deadline=None, derandomize=True, database=None)
    @given(ORDERS)
    def every_order(order: Any) -> None:
        assert known(databases, folder, order) == expected

    return every_order


@pytest.mark.parametrize(
    ("engine", "examples"),
    [
        ("sqlite", 1),
        pytest.param("sqlite", 3, marks=pytest.mark.slow),
        pytest.param("postgresql", 1, marks=pytest.mark.slow),
    ],
)
def test_any_order_and_any_detour_give_the_same_state(
    engine: str, examples: int, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    _holds(request.getfixturevalue(engine), tmp_path, examples)()
