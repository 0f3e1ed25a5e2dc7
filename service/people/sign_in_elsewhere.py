"""Flow: sign-in at an external provider. The account is found by issuer and subject, never by a name or an address,
which change hands; or it is made, where the operator allows it."""

import re
from collections.abc import Iterator
from datetime import datetime
from itertools import count

from estimator.errors import Problem
from estimator.message import say
from service.errors import ConflictError, ForbiddenError, RefusedError, SignInError
from service.kit.person import Account, Role
from service.people.changes import LAST_ADMIN, LOGIN, WRONG, begin
from service.people.provider import Claims, Joining, fault_of_subject
from service.people.store import Accounts, Identities
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store

FIRST = "There is no account yet, and the first one must be an admin's: make it with a link, or by the provider's role."
NO_ROLE = "The provider knows you, but gives you no role here. Ask an administrator."
NOT_INVITED = "The provider knows you, but there is no account for you here. Ask an administrator."
LONGEST_LOGIN = 50
"""Characters of a login derived from a claim; a number may be appended."""


def sign_in_elsewhere(storage: Storage, claims: Claims, joining: Joining, now: datetime) -> str:
    """The secret of the browser."""
    role = _claimed(claims, joining)
    with storage.database.writing() as store:
        Accounts(store).hold_admins()
        account = Identities(store).account(claims.issuer, claims.subject) or _made(store, claims, joining, role, now)
        if not account.is_active:
            raise SignInError(WRONG)
        if role is not None and role is not account.role:
            account = _with_role(store, account, role, claims, now)
        return begin(store, account, now, elsewhere=claims.issuer)


def _claimed(claims: Claims, joining: Joining) -> Role | None:
    """The role given by the provider; None where the provider does not decide it."""
    if not joining.by_claim:
        return None
    role = joining.role_of(claims.groups)
    if role is None:
        raise ForbiddenError(NO_ROLE)
    return role


def connect(storage: Storage, login: str, issuer: str, subject: str, now: datetime, *, who: str) -> Account:
    """Connects an existing account with a person at the provider."""
    fault = fault_of_subject(subject)
    if fault is not None:
        raise RefusedError("The account cannot be connected.", (Problem("subject", fault),))
    with storage.database.writing() as store:
        account = Accounts(store).get(login)
        if not Identities(store).add(account, issuer, subject, now):
            raise ConflictError("Somebody's account is connected with that one already.")
        Audit(store).write(now, who, "connect account", account.login, {"issuer": issuer, "subject": subject})
        return account


def _made(store: Store, claims: Claims, joining: Joining, role: Role | None, now: datetime) -> Account:
    new_role = role or joining.everybody
    if new_role is None:
        raise ForbiddenError(NOT_INVITED)
    if not Accounts(store).any() and new_role is not Role.ADMIN:
        raise ConflictError(FIRST)
    login = next(
        candidate
        for candidate in _logins(claims.login)
        if Accounts(store).add(candidate, claims.name or candidate, new_role, now)
    )
    account = Accounts(store).get(login)
    if not Identities(store).add(account, claims.issuer, claims.subject, now):
        raise ConflictError("You are signing in twice at once. Try again.")
    details = {"name": account.name, "role": new_role, "issuer": claims.issuer, "subject": claims.subject}
    Audit(store).write(now, account.name, "add account", login, details)
    return account


def _logins(claimed: str) -> Iterator[str]:
    """The login derived from the claim, then with numbers: one that exists belongs to another person."""
    plain = re.sub(r"[^a-z0-9._@-]+", "-", claimed.lower()).lstrip("._@-")[:LONGEST_LOGIN]
    base = plain if LOGIN.fullmatch(plain) else "user"
    yield base
    for number in count(2):
        yield f"{base}-{number}"


def _with_role(store: Store, account: Account, role: Role, claims: Claims, now: datetime) -> Account:
    """The account with the role that the provider gives today."""
    if account.role is Role.ADMIN and Accounts(store).admins() == 1:
        raise ConflictError(LAST_ADMIN)
    Accounts(store).put(account.login, name=account.name, role=role, is_active=True)
    details = {
        "before": {"role": account.role},
        "after": {"role": role},
        "why": say("said by {issuer}", issuer=claims.issuer),
    }
    Audit(store).write(now, account.name, "change account", account.login, details)
    return Accounts(store).get(account.login)
