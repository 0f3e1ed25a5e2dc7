"""Flow: a person acknowledges or resolves a flag and says why; the flag's life keeps all of it."""

from datetime import datetime

from service.errors import ConflictError
from service.records.flag import Flag, FlagState, NoticeKind
from service.storage import Storage

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


def _bring(storage: Storage, id: int, state: FlagState, *, who: str, why: str, now: datetime) -> Flag:
    with storage.database.writing() as store:
        unit = store.units.hold(store.flags.unit_of(id))
        flag = store.flags.get(id)
        if flag.state not in POSSIBLE[state]:
            raise ConflictError(f"Flag {id} is {flag.state.value} already, so it cannot be {state.value} now.")
        store.flags.put(id, now, state=state)
        store.notices.add(unit, DONE[state], now, who, why, flag=id)
        store.fleet.count_flags(unit)
        store.audit.write(now, who, DONE[state], flag.unit, {"flag": id, "why": why})
        return store.flags.get(id)
