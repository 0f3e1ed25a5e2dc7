"""Flow: a person acknowledges or resolves a flag and says why; the flag's life keeps all of it."""

from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime

from service.errors import ConflictError
from service.records.flag import Flag, FlagState, NoticeKind
from service.storage import Storage
from service.storage.store import Store

DONE = {FlagState.ACKNOWLEDGED: NoticeKind.ACKNOWLEDGED, FlagState.RESOLVED: NoticeKind.RESOLVED}
"""What the flag's life keeps of each."""
POSSIBLE = {
    FlagState.ACKNOWLEDGED: (FlagState.RAISED,),
    FlagState.RESOLVED: (FlagState.RAISED, FlagState.ACKNOWLEDGED),
}
"""From which states a flag can be brought into which."""


def acknowledge_flag(storage: Storage, id: int, who: str, why: str, now: datetime) -> Flag:
    """Somebody has seen the flag and looks after it; ConflictError where that was said before."""
    return _bring(storage, id, FlagState.ACKNOWLEDGED, who=who, why=why, now=now)


def resolve_flag(storage: Storage, id: int, who: str, why: str, now: datetime) -> Flag:
    """The matter is settled; ConflictError where it was before. Shown again by a later session it is a new flag."""
    return _bring(storage, id, FlagState.RESOLVED, who=who, why=why, now=now)


def bring_flags(storage: Storage, ids: Collection[int], state: FlagState, who: str, why: str, now: datetime) -> int:
    """The same said of several flags at once, all or none; how many it changed.

    Those of which somebody else has said so in the meantime are left alone.
    """
    with storage.database.writing() as store:
        units = {id: store.flags.unit_of(id) for id in ids}
        changed = 0
        for id in sorted(units, key=lambda id: (units[id], id)):
            unit = store.units.hold(units[id])
            if store.flags.get(id).state in POSSIBLE[state]:
                _put(store, Handled(id, unit, state, who=who, why=why, at=now))
                changed += 1
        return changed


@dataclass(frozen=True)
class Handled:
    """What somebody says of one flag."""

    id: int
    unit: int
    state: FlagState
    who: str
    why: str
    at: datetime


def _bring(storage: Storage, id: int, state: FlagState, *, who: str, why: str, now: datetime) -> Flag:
    with storage.database.writing() as store:
        unit = store.units.hold(store.flags.unit_of(id))
        flag = store.flags.get(id)
        if flag.state not in POSSIBLE[state]:
            raise ConflictError(f"Flag {id} is {flag.state.value} already, so it cannot be {state.value} now.")
        return _put(store, Handled(id, unit, state, who=who, why=why, at=now))


def _put(store: Store, said: Handled) -> Flag:
    store.flags.put(said.id, said.at, state=said.state)
    store.notices.add(said.unit, DONE[said.state], said.at, said.who, said.why, flag=said.id)
    store.fleet.count_flags(said.unit)
    flag = store.flags.get(said.id)
    store.audit.write(said.at, said.who, DONE[said.state], flag.unit, {"flag": said.id, "why": said.why})
    return flag
