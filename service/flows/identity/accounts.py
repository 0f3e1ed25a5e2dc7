"""Flow: accounts are made and changed; never deleted, for papers and the audit trail name them."""

import re
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
from service.errors import ConflictError, RefusedError, SignInError
from service.identity.passwords import fault_of, hashed, is_password
from service.records.identity import Account, Role
from service.storage import Storage
from service.storage.store import Store

LOGIN = re.compile(r"[a-z0-9][a-z0-9._@-]{0,59}")
"""What a login is made of; it stands in addresses and logs."""
LAST_ADMIN = "This is the only account that may administer the service: make another one an admin first."
UNCHANGED = "is the one that the account has; choose another"


@dataclass(frozen=True)
class AccountChange:
    """What is to be otherwise; None stays."""

    name: str | None = None
    role: Role | None = None
    is_active: bool | None = None


def require_login(login: str) -> str:
    """The login in small letters; RefusedError where it cannot be one."""
    small = login.strip().lower()
    if not LOGIN.fullmatch(small):
        fault = (
            "is made of letters a to z, digits and . _ @ -, begins with a letter or digit, and has at most 60 of them"
        )
        raise RefusedError("The login cannot be used.", (Problem("login", fault),))
    return small


def add_account(storage: Storage, login: str, name: str, role: Role, now: datetime, *, who: str) -> Account:
    """Makes an account that nobody can sign in to yet: a link lets its owner choose a password."""
    small = require_login(login)
    with storage.database.writing() as store:
        if not store.accounts.any() and role is not Role.ADMIN:
            raise ConflictError("The first account must be an admin: from then on everybody has to sign in.")
        shown = name.strip() or small
        if not store.accounts.add(small, shown, role, now):
            raise ConflictError(f"There is an account {small!r} already.")
        store.audit.write(now, who, "add account", small, {"name": shown, "role": role})
        return store.accounts.get(small)


def change_account(storage: Storage, login: str, change: AccountChange, now: datetime, *, who: str) -> Account:
    """Another name or role; or the account may no longer sign in, which ends browsers, links and tokens for good."""
    with storage.database.writing() as store:
        store.accounts.hold_admins()
        was = store.accounts.get(login)
        name = was.name if change.name is None else change.name.strip() or was.login
        role = was.role if change.role is None else change.role
        is_active = was.is_active if change.is_active is None else change.is_active
        loses = was.role is Role.ADMIN and was.is_active and not (role is Role.ADMIN and is_active)
        if loses and store.accounts.admins() == 1:
            raise ConflictError(LAST_ADMIN)
        store.accounts.put(was.login, name=name, role=role, is_active=is_active)
        ended = {} if is_active and was.is_active else end_access(store, was, now)
        found = store.accounts.get(was.login)
        if found != was:
            details = {"before": _plain(was), "after": _plain(found), **ended}
            store.audit.write(now, who, "change account", was.login, details)
        return found


def change_password(storage: Storage, login: str, old: str, new: str, now: datetime) -> None:
    """Another password, with the old one as proof; ends every browser, link and token of the account."""
    with storage.database.reading() as store:
        stored = store.accounts.password_hash(login)
    if not is_password(stored, old):
        raise SignInError("The old password is wrong.")
    require_new_password(stored, new)
    replacing = hashed(new)
    with storage.database.writing() as store:
        account = store.accounts.get(login)
        store.accounts.put_password_hash(login, replacing)
        ended = end_access(store, account, now)
        store.audit.write(now, account.name, "password", account.login, ended)


def require_new_password(stored: str | None, new: str) -> None:
    """RefusedError where a password cannot be the next one of an account whose present one is stored as given."""
    fault = fault_of(new)
    if fault is None and is_password(stored, new):
        fault = UNCHANGED
    if fault is not None:
        raise RefusedError("The password cannot be used.", (Problem("password", fault),))


def end_access(store: Store, account: Account, now: datetime) -> dict[str, object]:
    """Signs every browser of an account out, spends its links and revokes its tokens; returns what the audit trail
    says of it."""
    store.sign_ins.end_all(account)
    store.sign_ins.end_links(account)
    revoked = store.tokens.revoke_all(account, now)
    return {"tokens": list(revoked)} if revoked else {}


def _plain(account: Account) -> dict[str, object]:
    return {"name": account.name, "role": account.role, "is_active": account.is_active}
