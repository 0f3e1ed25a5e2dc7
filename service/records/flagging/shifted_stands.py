"""Flow: a stand that has shifted, as the units measured on it show, is flagged on those that it measured last."""

from collections.abc import Iterable
from datetime import datetime

from estimator.message import say
from service.errors import ServiceError
from service.flags.records import Concern, Flag, FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.kit.guard import Alone, plainly
from service.records.flagging.settle import Occasion, propose, raise_flag, see_again
from service.stands.health import stand_health
from service.stands.records import StandCondition
from service.stands.store import Stands
from service.storage import Storage
from service.units.store import Units

EVERY = 10_000
"""Flags of one unit: more than any unit has."""
GONE = "The units measured on {stand} no longer show that it has shifted."


def flag_shifted_stands(storage: Storage, now: datetime, alone: Alone = plainly) -> None:
    """One flag a unit and stand; a shift whose flag was resolved after it began is known and raises no other."""
    with storage.database.reading() as store:
        conditions = stand_health(store)
        opened = Flags(store).open_about(Matter.SHIFTED)
    shifted = [one for one in conditions if one.has_shifted]
    for one in shifted:
        with alone("stands", one.stand):
            _flag_all(storage, one, now, alone)
    for one in conditions:
        with alone("stands", one.stand):
            _require_whole(one)
    named = {one.stand for one in shifted}
    for flag in opened:
        if flag.place not in named:
            with alone("stands", flag.unit):
                _propose(storage, flag, now)


def _flag_all(storage: Storage, one: StandCondition, now: datetime, alone: Alone) -> None:
    """On every unit that the stand measured last."""
    since = min(shift.since for shift in one.shifts if shift.until is None)
    with storage.database.reading() as store:
        concerned = Stands(store).last_measured(one.stand, since)
    for serial in concerned:
        with alone("stands", serial):
            _flag(storage, serial, one, since, now)


def _flag(storage: Storage, serial: str, one: StandCondition, since: datetime, now: datetime) -> None:
    """An open flag says what is known now, also where the shift is dated anew."""
    concern = Concern(Matter.SHIFTED, one.stand, 1, one.reason)
    with storage.database.writing() as store:
        unit = Units(store).hold(serial)
        known = [flag for flag in Flags(store).page(FlagQuery(unit=serial, limit=EVERY)) if flag.key == concern.key]
        opened = [flag for flag in known if flag.state is not FlagState.RESOLVED]
        occasion = Occasion(unit, None, now)
        for flag in opened:
            if (flag.summary, flag.proposal) != (concern.summary, ""):
                see_again(store, occasion, flag, concern)
        if not opened and not _is_known(known, since):
            raise_flag(store, occasion, concern)


def _is_known(resolved: Iterable[Flag], since: datetime) -> bool:
    """Whether somebody settled the matter after the shift began."""
    return any(flag.changed_at >= since for flag in resolved)


def _propose(storage: Storage, flag: Flag, now: datetime) -> None:
    """Proposes to resolve a flag that no unit speaks for any more."""
    with storage.database.writing() as store:
        unit = Units(store).hold(flag.unit)
        for own in Flags(store).open_of(unit):
            if own.id == flag.id and not own.proposal:
                propose(store, Occasion(unit, None, now), own, say(GONE, stand=flag.place))


def _require_whole(one: StandCondition) -> None:
    """Tells of sessions whose common motion cannot be used; without them the stand is still judged."""
    if one.unreadable:
        raise ServiceError(
            say("What is stored of these sessions cannot be used: {why}.", why=", ".join(one.unreadable))
        )
