"""The stores of the service, opened with what a transaction that writes does last."""

from collections.abc import Callable

from service.fleet.tallies_store import Tallies
from service.judging.usable_reading import settle_uses
from service.settings import Settings
from service.storage import Storage
from service.storage.database import Database
from service.storage.files import Files, no_op
from service.storage.queries import Store
from service.storage.waits import Waits, waits_of


def settle(store: Store) -> None:
    """Brings the counts of the fleet and the uses of units in line."""
    tallies = Tallies(store)
    units = tallies.touched()
    if units:
        store.session.flush()
        tallies.settle(units)
        settle_uses(store, units)


def open_database(url: str, waits: Waits | None = None) -> Database:
    """The database at an address."""
    return Database(url, settle, waits)


def open_storage(settings: Settings, count: Callable[[str], None] = no_op) -> Storage:
    """The stores that the settings name; ``count`` is called for faults of files."""
    return Storage(open_database(settings.database, waits_of(settings.database_seconds)), Files(settings.files, count))
