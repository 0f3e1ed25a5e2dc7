"""The newest part of a unit's parameters through time."""

from datetime import datetime

from service.records.history import HistoryPoint
from service.storage.queries.history import HistoryQuery
from service.storage.store import Store


def recent_history(
    store: Store, serial: str, most: int, *, until: datetime | None = None, raw: bool = False, noise: bool = False
) -> tuple[HistoryPoint, ...]:
    """The newest sessions of a unit's history before a time, whole, with at most so many points; oldest first.

    ``raw``: what the whole block did is left in; ``noise``: the terms of noise stand among them.
    """
    unit = store.units.key(serial)
    wanted = HistoryQuery(until=until, limit=most + 1, newest=True, raw=raw, noise=noise)
    found = store.history.points(unit, wanted)
    if len(found) <= most:
        return found
    return tuple(point for point in found if point.session != found[0].session)
