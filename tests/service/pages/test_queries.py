"""List pages cost a fixed number of queries, however much is stored."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime

import pytest
from sqlalchemy import event

from service.flags.store import FlagQuery, Flags
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.judging.usable_reading import usable_of
from service.outlook.reading import outlook_of
from service.outlook.rules.populations import fleet_standouts
from service.outlook.store import Outlooks
from service.pages.stand.pages import every_stand, stand_report
from service.pages.type.pages import every_type, type_report
from service.pages.unit.report import unit_report
from service.papers.certified import session_report
from service.sessions.history_store import History, HistoryQuery
from service.sessions.records import SessionQuery
from service.sessions.store import Sessions
from service.stands.store import Stands
from service.storage import Storage
from service.storage.queries import Store
from service.types.store import UnitTypes
from service.units.store import Units
from service.uploads.receive import upload
from service.uploads.records import ArrivalQuery
from service.uploads.store import Arrivals
from tests.conftest import Filled
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
Page = Callable[[Store], object]
PAGES: dict[str, tuple[int, Page]] = {
    "fleet": (1, lambda store: Fleet(store).units(FleetQuery())),
    "condition": (1, lambda store: Fleet(store).condition()),
    "history": (2, lambda store: History(store).points(Units(store).key("BA-000"), HistoryQuery())),
    "the latest of every parameter": (2, lambda store: History(store).latest(Units(store).key("BA-000"))),
    "unit": (3, lambda store: unit_report(store, "BA-000", NOW)),
    "what units may be used for": (2, lambda store: usable_of(store, Fleet(store).units(FleetQuery()), NOW)),
    "flags": (1, lambda store: Flags(store).page(FlagQuery())),
    "flags of a unit": (1, lambda store: Flags(store).page(FlagQuery("BA-000"))),
    "outlook": (4, lambda store: outlook_of(store, "BA-000", NOW)),
    "due dates": (1, lambda store: Outlooks(store).due(100)),
    "standouts": (1, lambda store: fleet_standouts(store, 6)),
    "stands": (1, lambda store: Stands(store).conditions()),
    "types": (1, lambda store: UnitTypes(store).page(0, 100)),
    "list of sessions": (1, lambda store: Sessions(store).wanted(SessionQuery())),
    "list of stands": (4, every_stand),
    "stand": (8, lambda store: stand_report(store, "ODG-1", NOW)),
    "uploads": (2, lambda store: Arrivals(store).page(ArrivalQuery())),
    "list of types": (4, lambda store: every_type(store, NOW)),
    "type": (11, lambda store: type_report(store, "accelerometer × 6, V", NOW)),
}


@contextmanager
def counted(storage: Storage) -> Iterator[list[str]]:
    """The statements that a block sends."""
    statements: list[str] = []

    def note(_c: object, _k: object, statement: str, *_: object) -> None:
        statements.append(statement)

    event.listen(storage.database.engine, "before_cursor_execute", note)
    yield statements
    event.remove(storage.database.engine, "before_cursor_execute", note)


def queries(storage: Storage, page: Page) -> int:
    """Number of queries that a page costs."""
    with storage.database.reading() as store, counted(storage) as statements:
        page(store)
    return sum(not statement.startswith("BEGIN") for statement in statements)


def one_session(storage: Storage) -> None:
    upload(storage, session_bytes(unit="BA-000"), "a.json", NOW)


def three_more(storage: Storage) -> None:
    """Two of them of other units."""
    one_session(storage)
    for i in range(3):
        upload(storage, session_bytes(unit=f"BA-00{i}", seed=10 + i, m=4 if i else 6), "a.json", NOW)


@pytest.mark.parametrize("name", PAGES)
def test_queries_of_a_page_do_not_grow_with_the_fleet(filled: Filled, name: str) -> None:
    most, page = PAGES[name]
    assert queries(filled(three_more), page) == queries(filled(one_session), page) <= most


def test_a_session_report_is_three_queries(storage: Storage) -> None:
    id = upload(storage, session_bytes(), "a.json", NOW).id
    assert queries(storage, lambda store: session_report(store, id)) == 3
