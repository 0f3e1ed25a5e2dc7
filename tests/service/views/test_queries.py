"""List pages cost a fixed number of queries, however much is stored."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime

import pytest
from sqlalchemy import event

from service.flows.receive import upload
from service.judging.standouts import fleet_standouts
from service.records.arrival import ArrivalQuery
from service.records.fleet import FleetQuery
from service.records.session_list import SessionQuery
from service.storage import Storage
from service.storage.queries.flags import FlagQuery
from service.storage.queries.history import HistoryQuery
from service.storage.store import Store
from service.views.outlook import outlook_of
from service.views.session_report import session_report
from service.views.stand_report import every_stand, stand_report
from service.views.stands import stand_conditions
from service.views.type_report import every_type, type_report
from service.views.unit_report import unit_report
from tests.conftest import Filled
from tests.service.sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
Page = Callable[[Store], object]
PAGES: dict[str, tuple[int, Page]] = {
    "fleet": (1, lambda store: store.fleet.units(FleetQuery())),
    "condition": (1, lambda store: store.fleet.condition()),
    "history": (2, lambda store: store.history.points(store.units.key("BA-000"), HistoryQuery())),
    "unit": (3, lambda store: unit_report(store, "BA-000", NOW)),
    "sessions": (1, lambda store: store.sessions.page(None, 0, 100)),
    "flags": (1, lambda store: store.flags.page(FlagQuery())),
    "flags of a unit": (1, lambda store: store.flags.page(FlagQuery("BA-000"))),
    "outlook": (4, lambda store: outlook_of(store, "BA-000", NOW)),
    "due dates": (1, lambda store: store.outlooks.due(100)),
    "standouts": (1, lambda store: fleet_standouts(store, 6)),
    "stands": (1, stand_conditions),
    "types": (1, lambda store: store.unit_types.page(0, 100)),
    "list of sessions": (1, lambda store: store.sessions.wanted(SessionQuery())),
    "list of stands": (3, every_stand),
    "stand": (6, lambda store: stand_report(store, "ODG-1")),
    "uploads": (2, lambda store: store.arrivals.page(ArrivalQuery())),
    "list of types": (2, every_type),
    "type": (8, lambda store: type_report(store, "accelerometer × 6, V")),
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
    """How many queries a page costs."""
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
