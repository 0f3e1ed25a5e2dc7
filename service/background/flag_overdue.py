"""Flow: units whose calibration is overdue are flagged; the flag resolves itself once nothing is due any more."""

from datetime import datetime

from service.flows.flagging.settle import Occasion, raise_flag, resolve_as_done
from service.records.flag import Concern, Matter
from service.records.outlook import UnitOutlook
from service.storage import Storage
from service.views.outlook import fleet_outlook
from service.words.names import day_of


def flag_overdue(storage: Storage, now: datetime) -> None:
    """Raises a flag on every unit that is overdue and has none; resolves those of units that no longer are."""
    overdue = {outlook.serial: outlook for outlook in fleet_outlook(storage, now) if outlook.overdue}
    with storage.database.reading() as store:
        opened = {flag.unit for flag in store.flags.open_about(Matter.OVERDUE)}
    for serial in overdue.keys() ^ opened:
        _settle(storage, serial, overdue.get(serial), now)


def _settle(storage: Storage, serial: str, outlook: UnitOutlook | None, now: datetime) -> None:
    with storage.database.writing() as store:
        occasion = Occasion(store.units.hold(serial), None, now)
        opened = tuple(flag for flag in store.flags.open_of(occasion.unit) if flag.matter is Matter.OVERDUE)
        if outlook is None:
            for flag in opened:
                resolve_as_done(store, occasion, flag, "Nothing is due any more.")
        elif not opened and outlook.due is not None:
            summary = f"Calibration was due on {day_of(outlook.due)}. {outlook.reason}"
            raise_flag(store, occasion, Concern(Matter.OVERDUE, "", 1, summary))
