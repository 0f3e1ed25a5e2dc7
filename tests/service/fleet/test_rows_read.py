"""A page reads the rows that it shows, however many units there are. PostgreSQL says what it reads."""

from collections import Counter
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from typing import Any

import pytest
from sqlalchemy import event

from benchmarks.fleet.fill import multiply
from service.fleet.records import FleetQuery, Order
from service.fleet.store import Fleet
from service.storage import Storage
from service.storage.queries import Store
from tests.conftest import Filled
from tests.service.dated import upload_and_date
from tests.service.made_sessions import session_bytes

pytestmark = pytest.mark.parametrize("databases", ["postgresql"], indirect=True)
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
UNITS, SESSIONS, SHOWN = 500, 2, 5
"""Units of the fleet, sessions of each of its units, and units on a page."""
LISTS = {
    "the first page": FleetQuery(limit=SHOWN),
    "after a unit": FleetQuery(limit=SHOWN, after="BA-000-00100"),
    "before a unit": FleetQuery(limit=SHOWN, before="BA-000-00100"),
    "by a part of the name": FleetQuery(limit=SHOWN, text="-002"),
    "of a stand": FleetQuery(limit=SHOWN, stand="ODG-1", order=Order.LAST, backwards=True),
}


def fleet(storage: Storage) -> None:
    """Many copies of one unit."""
    for month in range(1, SESSIONS + 1):
        upload_and_date(storage, session_bytes(unit="BA-000", seed=month, month=month), "a.json", NOW)
    multiply(storage, UNITS)


def rows_read(storage: Storage, page: Callable[[Store], object]) -> Counter[str]:
    """Number of rows of each table that the statements of a page go through."""
    asked: list[tuple[str, Any]] = []

    def note(_c: object, _k: object, statement: str, parameters: object, *_: object) -> None:
        asked.append((statement, parameters))

    engine = storage.database.engine
    event.listen(engine, "before_cursor_execute", note)
    with storage.database.reading() as store:
        page(store)
    event.remove(engine, "before_cursor_execute", note)
    rows: Counter[str] = Counter()
    with engine.connect() as connection:
        for statement, parameters in asked:
            plan = connection.exec_driver_sql(f"EXPLAIN (ANALYZE, FORMAT JSON) {statement}", parameters).scalar_one()
            for node in nodes(plan[0]["Plan"]):
                gone_through = node["Actual Rows"] + node.get("Rows Removed by Filter", 0)
                rows[node.get("Relation Name", "")] += round(gone_through * node["Actual Loops"])
    return rows


def nodes(plan: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """A plan's steps."""
    yield plan
    for part in plan.get("Plans", ()):
        yield from nodes(part)


@pytest.mark.parametrize("name", LISTS)
def test_a_page_of_units_reads_their_latest_sessions_only(filled: Filled, name: str) -> None:
    read = rows_read(filled(fleet), lambda store: Fleet(store).units(LISTS[name]))
    assert read["sessions"] == read["decisions"] == read["outlooks"] == SHOWN
    assert read["diagnoses"] <= SHOWN
