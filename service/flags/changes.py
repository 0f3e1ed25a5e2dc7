"""Flags are assigned, acknowledged and resolved; each keeps who did it, when and why."""

import re
from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
from estimator.message import joined, say
from service.errors import ConflictError, RefusedError
from service.flags.mail import SCHEME
from service.flags.records import NOBODY, Assignee, Flag, FlagState, NoticeKind, Webhook
from service.flags.store import Flags, Notices
from service.flags.webhooks_store import Webhooks
from service.fleet.store import Fleet
from service.kit.libraries import httpx
from service.people.store import Accounts
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.units.store import Units

UNKNOWN = "no account with this login or name may sign in; leave it empty for nobody"
SEVERAL = "several accounts have this name; give the login"


@dataclass(frozen=True)
class Assignment:
    """Assignment of flags, with the person and the reason."""

    to: str
    """Login or name; empty for nobody in particular. Where there are no accounts, any name."""
    who: str
    why: str = ""


def assign_flag(storage: Storage, id: int, said: Assignment, now: datetime) -> Flag:
    """Gives one flag to somebody; ConflictError where it is resolved."""
    with storage.database.writing() as store:
        unit, assignee = Units(store).hold(Flags(store).unit_of(id)), assignee_of(store, said.to)
        flag = Flags(store).get(id)
        if flag.state is FlagState.RESOLVED:
            raise ConflictError("Flag {id} is already resolved: it cannot be assigned.", id=id)
        _put(store, flag, unit, assignee, said=said, now=now)
        return Flags(store).get(id)


def assign_flags(storage: Storage, ids: Collection[int], said: Assignment, now: datetime) -> int:
    """Assigns several flags, all or none, and returns the number of changed ones. Those that were resolved meanwhile
    are left alone.
    """
    with storage.database.writing() as store:
        assignee = assignee_of(store, said.to)
        units, changed = {id: Flags(store).unit_of(id) for id in ids}, 0
        for id in sorted(units, key=lambda id: (units[id], id)):
            unit, flag = Units(store).hold(units[id]), Flags(store).get(id)
            if flag.state is not FlagState.RESOLVED:
                changed += _put(store, flag, unit, assignee, said=said, now=now)
        return changed


def assignee_of(store: Store, said: str) -> Assignee:
    """Whom a login or a name means; RefusedError where that is nobody, or several."""
    meant = said.strip()
    if not meant:
        return NOBODY
    accounts = [account for account in Accounts(store).every() if account.is_active]
    if not Accounts(store).any():
        return Assignee(meant)
    by_login = [account for account in accounts if account.login == meant.lower()]
    found = by_login or [account for account in accounts if account.name == meant]
    if len(found) != 1:
        fault = SEVERAL if found else UNKNOWN
        raise RefusedError("The flag cannot be assigned.", (Problem("to", fault),))
    return Assignee(found[0].name or found[0].login, found[0].login)


def _put(store: Store, flag: Flag, unit: int, assignee: Assignee, *, said: Assignment, now: datetime) -> bool:
    """Whether that is new."""
    if Flags(store).assignee_of(flag.id) == assignee:
        return False
    Flags(store).put(flag.id, now, assignee=assignee.name, assignee_login=assignee.login)
    text = say("To {name}.", name=assignee.name) if assignee.name else "To nobody."
    Notices(store).add(
        unit, NoticeKind.ASSIGNED, now, said.who, joined(" ", filter(None, (text, said.why))), flag=flag.id
    )
    details = {"flag": flag.id, "to": assignee.name, "login": assignee.login, "why": said.why}
    Audit(store).write(now, said.who, NoticeKind.ASSIGNED, flag.unit, details)
    return True


DONE = {FlagState.ACKNOWLEDGED: NoticeKind.ACKNOWLEDGED, FlagState.RESOLVED: NoticeKind.RESOLVED}
"""Kind of notice for each state."""
POSSIBLE = {
    FlagState.ACKNOWLEDGED: (FlagState.RAISED,),
    FlagState.RESOLVED: (FlagState.RAISED, FlagState.ACKNOWLEDGED),
}
"""States from which a flag can be brought into a state."""


def acknowledge_flag(storage: Storage, id: int, who: str, why: str, now: datetime) -> Flag:
    """Marks a flag as seen and looked after; ConflictError where it already is."""
    return _bring(storage, id, FlagState.ACKNOWLEDGED, who=who, why=why, now=now)


def resolve_flag(storage: Storage, id: int, who: str, why: str, now: datetime) -> Flag:
    """The matter is settled; ConflictError where it was before. Shown again by a later session it is a new flag."""
    return _bring(storage, id, FlagState.RESOLVED, who=who, why=why, now=now)


def bring_flags(storage: Storage, ids: Collection[int], state: FlagState, who: str, why: str, now: datetime) -> int:
    """Brings several flags to a state, all or none, and returns the number of changed ones.

    Those that somebody else has brought there in the meantime are left alone.
    """
    with storage.database.writing() as store:
        units = {id: Flags(store).unit_of(id) for id in ids}
        changed = 0
        for id in sorted(units, key=lambda id: (units[id], id)):
            unit = Units(store).hold(units[id])
            if Flags(store).get(id).state in POSSIBLE[state]:
                _keep(store, FlagHandling(id, unit, state, who=who, why=why, at=now))
                changed += 1
        return changed


@dataclass(frozen=True)
class FlagHandling:
    """Change of one flag's state, with the person and the reason."""

    id: int
    unit: int
    state: FlagState
    who: str
    why: str
    at: datetime


def _bring(storage: Storage, id: int, state: FlagState, *, who: str, why: str, now: datetime) -> Flag:
    with storage.database.writing() as store:
        unit = Units(store).hold(Flags(store).unit_of(id))
        flag = Flags(store).get(id)
        if flag.state not in POSSIBLE[state]:
            parts = {"id": id, "state": flag.state.value, "new_state": state.value}
            raise ConflictError("Flag {id} is already {state}: it cannot be {new_state} now.", **parts)
        return _keep(store, FlagHandling(id, unit, state, who=who, why=why, at=now))


def _keep(store: Store, said: FlagHandling) -> Flag:
    Flags(store).put(said.id, said.at, state=said.state)
    Notices(store).add(said.unit, DONE[said.state], said.at, said.who, said.why, flag=said.id)
    Fleet(store).count_flags(said.unit)
    flag = Flags(store).get(said.id)
    Audit(store).write(said.at, said.who, DONE[said.state], flag.unit, {"flag": said.id, "why": said.why})
    return flag


MAIL_ADDRESS = re.compile(r"mailto:[A-Za-z0-9.!#$%&'*+/=?^_`{|}~-]{1,64}@[A-Za-z0-9.-]{1,253}")
"""One receiver, without the fields of a mailto address."""
NO_SERVER = "is an e-mail address, but no mail server is set: the operator sets IMU_HEALTH_MAIL_HOST and _FROM"
SCHEMES = ("http", "https")
"""Schemes of addresses of webhooks."""


def register_webhook(
    storage: Storage, hosts: tuple[str, ...], url: str, secret: str, *, who: str, now: datetime, has_mail: bool = False
) -> Webhook:
    """Registers an address; RefusedError unless its host may be called, or e-mail be sent."""
    fault = fault_of(url, hosts, has_mail=has_mail)
    if fault or not (secret or url.startswith(SCHEME)):
        problem = Problem("url", fault) if fault else Problem("secret", "is missing; messages to a host are signed")
        raise RefusedError("The webhook cannot be registered.", (problem,))
    with storage.database.writing() as store:
        webhook = Webhooks(store).add(url, secret, who, now)
        Audit(store).write(now, who, "add webhook", str(webhook.id), {"url": url})
        return webhook


def fault_of(url: str, hosts: tuple[str, ...], *, has_mail: bool = False) -> str:
    """The reason why an address may not be called; empty where it may.

    It is read by the library that will call it, so that no spelling of a host means one thing here and another there.
    """
    if url.startswith(SCHEME):
        if not MAIL_ADDRESS.fullmatch(url):
            return "is no e-mail address; write it like mailto:crew@example.org"
        return "" if has_mail else NO_SERVER
    try:
        parsed = httpx.URL(url)
    except (httpx.InvalidURL, ValueError):
        return "is not an address; write it like https://example.org/hook"
    if parsed.scheme not in SCHEMES or not parsed.host:
        return "must begin with https:// or http:// and name a host"
    if parsed.userinfo:
        return "holds a user name or a password; leave them out, every message is signed with the secret"
    host = f"[{parsed.host}]" if ":" in parsed.host else parsed.host
    wanted = host if parsed.port is None else f"{host}:{parsed.port}"
    if wanted.lower() not in {allowed.lower() for allowed in hosts}:
        return say(
            "leads to {host}, which this service may not call; whoever runs it can allow it with "
            "IMU_HEALTH_WEBHOOK_HOSTS",
            host=wanted,
        )
    return ""


def remove_webhook(storage: Storage, id: int, who: str, now: datetime) -> None:
    """Stops notifying an address."""
    with storage.database.writing() as store:
        url = Webhooks(store).get(id).url
        Webhooks(store).remove(id, now)
        Audit(store).write(now, who, "remove webhook", str(id), {"url": url})
