"""Flow: a stand that has shifted, as the units measured on it show, is flagged on those that it measured last."""

from datetime import datetime

from service.flows.flagging.settle import Occasion, raise_flag
from service.records.flag import Concern, Matter
from service.records.stand import StandCondition
from service.storage import Storage
from service.storage.queries.flags import FlagQuery
from service.views.stands import stand_conditions

EVERY = 10_000
"""Flags of one unit: more than any unit has."""


def flag_shifted_stands(storage: Storage, now: datetime) -> None:
    """One flag a unit and shift; a shift whose flag was resolved is known and raises no other."""
    with storage.database.reading() as store:
        shifted = [(one, _since(one)) for one in stand_conditions(store) if one.has_shifted]
        concerned = [
            (serial, one, since) for one, since in shifted for serial in store.stands.last_measured(one.stand, since)
        ]
    for serial, one, since in concerned:
        _flag(storage, serial, one, since, now)


def _since(condition: StandCondition) -> datetime:
    return min(evidence.since for evidence in condition.evidence if evidence.has_shifted)


def _flag(storage: Storage, serial: str, condition: StandCondition, since: datetime, now: datetime) -> None:
    concern = Concern(Matter.SHIFTED, condition.stand, 1, condition.reason)
    with storage.database.writing() as store:
        unit = store.units.hold(serial)
        known = store.flags.page(FlagQuery(unit=serial, limit=EVERY))
        if not any(flag.key == concern.key and flag.raised_at >= since for flag in known):
            raise_flag(store, Occasion(unit, None, now), concern)
