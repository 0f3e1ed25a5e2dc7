"""Flows: the parameters of one unit through time."""

from datetime import datetime

from service.records.history import HistoryPoint
from service.storage.queries.history import HistoryQuery
from service.storage.store import Store


def unit_history(
    store: Store,
    serial: str,
    *,
    parameter: str | None = None,
    sensor: str | None = None,
    since: datetime | None = None,
    until: datetime | None = None,
    revision: int | None = None,
    page: int = 1,
    limit: int = 10_000,
) -> tuple[HistoryPoint, ...]:
    """One page of a unit's history, oldest first: value, uncertainty, band, tolerance and verdict of every point."""
    unit = store.units.key(serial)
    return store.history.points(
        unit, HistoryQuery(parameter, sensor, since, until, (page - 1) * limit, limit, revision)
    )


def recent_history(store: Store, serial: str, most: int, *, until: datetime | None = None) -> tuple[HistoryPoint, ...]:
    """The newest sessions of a unit's history before a time, whole, with at most so many points; oldest first."""
    unit = store.units.key(serial)
    found = store.history.points(unit, HistoryQuery(until=until, limit=most + 1, newest=True))
    if len(found) <= most:
        return found
    return tuple(point for point in found if point.session != found[0].session)
