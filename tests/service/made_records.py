"""All that is derived of a unit's records, as one value that can be compared."""

from datetime import UTC, datetime
from typing import Any

from service.flags.records import FlagState
from service.flags.store import FlagQuery, Flags
from service.fleet.store import Fleet
from service.outlook.store import Outlooks
from service.records.derive_again import Deriving
from service.sessions.calibrations_store import Calibrations
from service.sessions.history_store import History, HistoryQuery
from service.sessions.states import RecordState, Step
from service.sessions.store import Sessions
from service.stands.store import Stands
from service.storage import Storage
from service.storage.queries import Store
from service.units.store import Units

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def step(why: str = "wrong unit") -> Step:
    """A step of an engineer."""
    return Step("K. Ito", NOW, why)


def way(storage: Storage, at_once: int | None = 20) -> Deriving:
    """Options of the derivation that follows."""
    return Deriving(storage.files, 2.0, NOW, at_once)


def state_of(storage: Storage, *serials: str) -> dict[str, Any]:
    """The state of units, to the last digit; without times and numbers of writing."""
    with storage.database.reading() as store:
        units = {serial: _unit(store, serial) for serial in serials if Units(store).exists(serial)}
        return units | {"stands": Stands(store).motions()}


def _unit(store: Store, serial: str) -> dict[str, Any]:
    counted = [s for s in Sessions(store).of_unit(serial) if s.state is RecordState.ACCEPTED]
    flags = [f for f in Flags(store).page(FlagQuery(serial)) if f.state is not FlagState.RESOLVED]
    return {
        "sessions": [(s.id, s.verdict, s.reason, s.is_reference, s.revision) for s in counted],
        "decisions": [Sessions(store).decisions(s.id) for s in counted],
        "motions": [Sessions(store).motions(s.id) for s in counted],
        "calibrations": [Calibrations(store).json(s.id) for s in counted],
        "history": History(store).points(Units(store).key(serial), HistoryQuery()),
        "outlook": Outlooks(store).of_unit(serial),
        "condition": Fleet(store).unit(serial),
        "flags": sorted((f.key, f.severity, f.summary, f.proposal, f.session) for f in flags),
    }
