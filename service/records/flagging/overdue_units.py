"""Flow: units whose calibration is overdue are flagged; the flag resolves itself once nothing is due any more."""

from dataclasses import replace
from datetime import datetime

from service.flags.records import Matter
from service.flags.store import Flags
from service.fleet.store import Fleet
from service.kit.guard import Alone, plainly
from service.outlook.store import Outlooks
from service.records.flagging.acts import Occasion, raise_flag
from service.records.flagging.drift import flag_drift
from service.records.flagging.lasting import no_longer_overdue, overdue_by
from service.storage import Storage
from service.units.store import Units


def flag_overdue(storage: Storage, now: datetime, alone: Alone = plainly) -> None:
    """Raises a flag on every unit that is overdue and has none; resolves those of units that no longer are."""
    with storage.database.reading() as store:
        late = Outlooks(store).overdue_units(now)
        opened = [flag.unit for flag in Flags(store).open_about(Matter.OVERDUE)]
    for serial in sorted({*late, *opened}):
        with alone("due dates", serial):
            _settle_overdue(storage, serial, now)


def _settle_overdue(storage: Storage, serial: str, now: datetime) -> None:
    with storage.database.writing() as store:
        occasion = Occasion(Units(store).hold(serial), None, now)
        outlook = Outlooks(store).of_unit(serial)
        concern = overdue_by(outlook, now)
        if no_longer_overdue(store, occasion, outlook):
            return
        if concern is not None:
            raise_flag(store, occasion, concern)
        unit = Fleet(store).unit(serial)
        flag_drift(store, replace(occasion, session=None if unit is None else unit.last_session), outlook)
