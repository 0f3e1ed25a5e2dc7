"""Flow: units whose calibration is overdue are flagged; the flag resolves itself once nothing is due any more."""

from collections.abc import Callable
from datetime import datetime
from threading import Event

from service.background.shifted_stands import flag_shifted_stands
from service.errors import ServiceError
from service.flows.flagging.settle import Found, settle
from service.flows.flagging.verdict import resolve_as_done
from service.log import log
from service.records.flag import Concern, Matter
from service.records.outlook import UnitOutlook
from service.storage import Storage
from service.views.outlook import fleet_outlook
from service.words.names import day_of

FIRST_LOOK, LOOK_EVERY = 20.0, 3600.0
"""Seconds after the start, and between two looks."""


def watch_fleet(storage: Storage, clock: Callable[[], datetime], stop: Event) -> None:
    """Looks at every due date and every stand now and then until ``stop`` is set."""
    pause = FIRST_LOOK
    while not stop.wait(pause):
        pause = LOOK_EVERY
        try:
            flag_overdue(storage, clock())
            flag_shifted_stands(storage, clock())
        except ServiceError as fault:
            log.warning("due dates and stands looked at later", reason=str(fault))


def flag_overdue(storage: Storage, now: datetime) -> None:
    """Raises a flag on every unit that is overdue and has none; resolves those of units that no longer are."""
    overdue = {outlook.serial: outlook for outlook in fleet_outlook(storage, now) if outlook.overdue}
    with storage.database.reading() as store:
        opened = {flag.unit for flag in store.flags.open_about(Matter.OVERDUE)}
    for serial in overdue.keys() ^ opened:
        _settle(storage, serial, overdue.get(serial), now)


def _settle(storage: Storage, serial: str, outlook: UnitOutlook | None, now: datetime) -> None:
    with storage.database.writing() as store:
        unit = store.units.hold(serial)
        opened = tuple(flag for flag in store.flags.open_of(unit) if flag.matter is Matter.OVERDUE)
        if outlook is None:
            for flag in opened:
                resolve_as_done(store, unit, flag, "Nothing is due any more.", now, None)
        elif not opened and outlook.due is not None:
            summary = f"Calibration was due on {day_of(outlook.due)}. {outlook.reason}"
            settle(store, unit, (), Found((Concern(Matter.OVERDUE, "", 1, summary),), {}), None, now)
