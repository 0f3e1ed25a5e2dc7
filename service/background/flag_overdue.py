"""Flow: units whose calibration is overdue are flagged; the flag resolves itself once nothing is due any more."""

from datetime import datetime

from service.flows.flagging.overdue import no_longer_overdue, overdue_by
from service.flows.flagging.settle import Occasion, raise_flag
from service.flows.guard import Alone, plainly
from service.records.flag import Matter
from service.storage import Storage


def flag_overdue(storage: Storage, now: datetime, alone: Alone = plainly) -> None:
    """Raises a flag on every unit that is overdue and has none; resolves those of units that no longer are."""
    with storage.database.reading() as store:
        late = store.outlooks.overdue_units(now)
        opened = [flag.unit for flag in store.flags.open_about(Matter.OVERDUE)]
    for serial in sorted({*late, *opened}):
        with alone("due dates", serial):
            _settle(storage, serial, now)


def _settle(storage: Storage, serial: str, now: datetime) -> None:
    with storage.database.writing() as store:
        occasion = Occasion(store.units.hold(serial), None, now)
        outlook = store.outlooks.of_unit(serial)
        concern = overdue_by(outlook, now)
        if not no_longer_overdue(store, occasion, outlook) and concern is not None:
            raise_flag(store, occasion, concern)
