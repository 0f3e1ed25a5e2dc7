"""Flow: somebody is to look after flags; each flag's life, and the audit trail, keep who said so."""

from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
from service.errors import ConflictError, RefusedError
from service.records.flag import NOBODY, Assignee, Flag, FlagState, NoticeKind
from service.storage import Storage
from service.storage.store import Store

UNKNOWN = "is the login or the name of no account that may sign in; leave it empty for nobody"
SEVERAL = "is the name of several accounts; say the login"


@dataclass(frozen=True)
class Assignment:
    """What somebody says of flags."""

    to: str
    """Login or name; empty for nobody in particular. Where there are no accounts, any name."""
    who: str
    why: str = ""


def assign_flag(storage: Storage, id: int, said: Assignment, now: datetime) -> Flag:
    """Gives one flag to somebody; ConflictError where it is resolved."""
    with storage.database.writing() as store:
        unit, assignee = store.units.hold(store.flags.unit_of(id)), assignee_of(store, said.to)
        flag = store.flags.get(id)
        if flag.state is FlagState.RESOLVED:
            raise ConflictError(f"Flag {id} is resolved already, so nobody has to look after it.")
        _put(store, flag, unit, assignee, said=said, now=now)
        return store.flags.get(id)


def assign_flags(storage: Storage, ids: Collection[int], said: Assignment, now: datetime) -> int:
    """The same of several, all or none; how many it changed. Those that were resolved meanwhile are left alone."""
    with storage.database.writing() as store:
        assignee = assignee_of(store, said.to)
        units, changed = {id: store.flags.unit_of(id) for id in ids}, 0
        for id in sorted(units, key=lambda id: (units[id], id)):
            unit, flag = store.units.hold(units[id]), store.flags.get(id)
            if flag.state is not FlagState.RESOLVED:
                changed += _put(store, flag, unit, assignee, said=said, now=now)
        return changed


def assignee_of(store: Store, said: str) -> Assignee:
    """Whom a login or a name means; RefusedError where that is nobody, or several."""
    meant = said.strip()
    if not meant:
        return NOBODY
    accounts = [account for account in store.accounts.every() if account.is_active]
    if not store.accounts.any():
        return Assignee(meant)
    by_login = [one for one in accounts if one.login == meant.lower()]
    found = by_login or [one for one in accounts if one.name == meant]
    if len(found) != 1:
        fault = SEVERAL if found else UNKNOWN
        raise RefusedError("The flag cannot be assigned.", (Problem("to", fault),))
    return Assignee(found[0].name or found[0].login, found[0].login)


def _put(store: Store, flag: Flag, unit: int, assignee: Assignee, *, said: Assignment, now: datetime) -> bool:
    """Whether that is new."""
    if store.flags.assignee_of(flag.id) == assignee:
        return False
    store.flags.put(flag.id, now, assignee=assignee.name, assignee_login=assignee.login)
    text = f"To {assignee.name}." if assignee.name else "To nobody in particular."
    store.notices.add(unit, NoticeKind.ASSIGNED, now, said.who, f"{text} {said.why}".strip(), flag=flag.id)
    details = {"flag": flag.id, "to": assignee.name, "login": assignee.login, "why": said.why}
    store.audit.write(now, said.who, NoticeKind.ASSIGNED, flag.unit, details)
    return True
