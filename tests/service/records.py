"""Everything that is derived of a unit's records, as one value that can be compared."""

from datetime import UTC, datetime
from typing import Any

from service.flows.derive_again import Deriving
from service.records.flag import FlagState
from service.records.state import RecordState, Step
from service.storage import Storage
from service.storage.queries.flags import FlagQuery
from service.storage.queries.history import HistoryQuery
from service.storage.store import Store

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def step(why: str = "wrong unit") -> Step:
    """What an engineer does."""
    return Step("K. Ito", NOW, why)


def way(storage: Storage, at_once: int | None = 20) -> Deriving:
    """How what follows is derived."""
    return Deriving(storage.files, 2.0, NOW, at_once)


def state_of(storage: Storage, *serials: str) -> dict[str, Any]:
    """What is known of units, to the last digit; when and under which number it was written down apart."""
    with storage.database.reading() as store:
        units = {serial: _unit(store, serial) for serial in serials if store.units.exists(serial)}
        return units | {"stands": store.stands.motions()}


def _unit(store: Store, serial: str) -> dict[str, Any]:
    counted = [s for s in store.sessions.of_unit(serial) if s.state is RecordState.ACCEPTED]
    flags = [f for f in store.flags.page(FlagQuery(serial)) if f.state is not FlagState.RESOLVED]
    return {
        "sessions": [(s.id, s.verdict, s.reason, s.is_reference, s.revision) for s in counted],
        "decisions": [store.sessions.decisions(s.id) for s in counted],
        "motions": [store.sessions.motions(s.id) for s in counted],
        "calibrations": [store.calibrations.json(s.id) for s in counted],
        "history": store.history.points(store.units.key(serial), HistoryQuery()),
        "outlook": store.outlooks.of_unit(serial),
        "condition": store.fleet.unit(serial),
        "flags": sorted((f.key, f.severity, f.summary, f.proposal, f.session) for f in flags),
    }
