"""Changes of accounts, passwords, sign-in links and tokens; accounts are never deleted.

Attempts to sign in are limited by account and address together, so that guessing locks out nobody but those at the same
address; by address, against one password on many accounts; and by account, with a far higher limit, against many
addresses. A browser that has signed in to the account before has its own count, and is not affected by others. Attempts
are counted in the database, before the password is checked: many processes or concurrent requests get no more attempts
than one.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from hashlib import sha256

from estimator.errors import Problem, problem_at
from estimator.message import say
from service.errors import ConflictError, ForbiddenError, RefusedError, SignInError, TooOftenError
from service.ingest.names import LONGEST_NAME
from service.kit.person import Account, Person, Role, Token
from service.kit.text import OF_A_LINE, fault_of_text
from service.people.secret import TOKEN_PREFIX, fault_of, hashed, is_password, new_secret, stored_hash
from service.people.store import Accounts, Attempts, SignIns, Tokens
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store

LOGIN = re.compile(r"[a-z0-9][a-z0-9._@-]{0,59}")
"""Pattern of a login; it appears in addresses and logs."""
LAST_ADMIN = "This is the only account that may administer the service: make another one an admin first."
UNCHANGED = "is the one that the account has; choose another"


@dataclass(frozen=True)
class AccountChange:
    """Changed fields; None stays."""

    name: str | None = None
    role: Role | None = None
    is_active: bool | None = None


def require_login(login: str) -> str:
    """The login in lower case; RefusedError for an invalid one."""
    lower = login.strip().lower()
    if not LOGIN.fullmatch(lower):
        fault = (
            "is made of letters a to z, digits and . _ @ -, begins with a letter or digit, and has at most 60 of them"
        )
        raise RefusedError("The login cannot be used.", (Problem("login", fault),))
    return lower


def require_name(field: str, text: str) -> str:
    """The text without spaces around it; RefusedError where it is no name."""
    name = text.strip()
    fault = fault_of_text(name, OF_A_LINE)
    if len(name) > LONGEST_NAME:
        fault = say("is longer than {longest} characters", longest=LONGEST_NAME)
    if fault is not None:
        raise RefusedError("The name cannot be used.", (Problem(field, fault),))
    return name


def add_account(storage: Storage, login: str, name: str, role: Role, now: datetime, *, who: str) -> Account:
    """Makes an account without a password: a link lets its owner choose one."""
    lower = require_login(login)
    shown_name = require_name("name", name) or lower
    with storage.database.writing() as store:
        if not Accounts(store).any() and role is not Role.ADMIN:
            raise ConflictError("The first account must be an admin: from then on everybody has to sign in.")
        if not Accounts(store).add(lower, shown_name, role, now):
            raise ConflictError("There is an account {small} already.", small=repr(lower))
        Audit(store).write(now, who, "add account", lower, {"name": shown_name, "role": role})
        return Accounts(store).get(lower)


def change_account(storage: Storage, login: str, change: AccountChange, now: datetime, *, who: str) -> Account:
    """Changes name or role; or deactivates the account, which ends browsers, links and tokens for good."""
    with storage.database.writing() as store:
        Accounts(store).hold_admins()
        before = Accounts(store).get(login)
        name = before.name if change.name is None else require_name("name", change.name) or before.login
        role = before.role if change.role is None else change.role
        is_active = before.is_active if change.is_active is None else change.is_active
        loses_admin = before.role is Role.ADMIN and before.is_active and not (role is Role.ADMIN and is_active)
        if loses_admin and Accounts(store).admins() == 1:
            raise ConflictError(LAST_ADMIN)
        Accounts(store).put(before.login, name=name, role=role, is_active=is_active)
        ended = {} if is_active and before.is_active else end_access(store, before, now)
        after = Accounts(store).get(before.login)
        if after != before:
            details = {"before": _plain(before), "after": _plain(after), **ended}
            Audit(store).write(now, who, "change account", before.login, details)
        return after


def change_password(storage: Storage, login: str, old: str, new: str, now: datetime) -> None:
    """Changes the password, with the old one as proof; ends every browser, link and token of the account."""
    with storage.database.reading() as store:
        stored = Accounts(store).password_hash(login)
    if not is_password(stored, old):
        raise SignInError("The old password is wrong.")
    require_new_password(stored, new)
    new_hash = hashed(new)
    with storage.database.writing() as store:
        account = Accounts(store).get(login)
        Accounts(store).put_password_hash(login, new_hash)
        ended = end_access(store, account, now)
        Audit(store).write(now, account.name, "password", account.login, ended)


def require_new_password(stored: str | None, new: str) -> None:
    """RefusedError where a new password is invalid or the same as the stored one."""
    fault = fault_of(new)
    if fault is None and is_password(stored, new):
        fault = UNCHANGED
    if fault is not None:
        raise RefusedError("The password cannot be used.", (Problem("password", fault),))


def end_access(store: Store, account: Account, now: datetime) -> dict[str, object]:
    """Signs out all browsers of an account, ends its links and revokes its tokens; returns audit details."""
    SignIns(store).end_all(account)
    SignIns(store).end_links(account)
    revoked = Tokens(store).revoke_all(account, now)
    return {"tokens": list(revoked)} if revoked else {}


def _plain(account: Account) -> dict[str, object]:
    return {"name": account.name, "role": account.role, "is_active": account.is_active}


MINUTE, DAY = timedelta(minutes=1), timedelta(days=1)
LOGIN_LIMIT, ADDRESS_LIMIT = 5, 20
"""Wrong attempts a minute: an owner mistypes a password once or twice; several people share an address."""
DAILY_LIMIT = 20
"""Wrong attempts a day at one account from one address, or from one remembered browser."""
DAILY_LIMIT_OF_ALL = 100
"""Wrong attempts a day at one account from all other browsers: of a million common passwords 0.01 % a day, however many
addresses try them."""
TOO_OFTEN = "Too many wrong attempts. Wait a minute, then try again."
ENOUGH_TODAY = (
    "Too many wrong attempts today. Try again tomorrow, from a browser that has signed in to this account before, "
    "or ask an administrator for a link."
)


@dataclass(frozen=True)
class SignInAttempt:
    """An attempt at a password."""

    login: str
    address: str
    browser: str = ""
    """Identifier of a browser that has signed in to this account before; empty for any other."""


@dataclass(frozen=True)
class _Limit:
    key: str
    """A hash, since people also type passwords as logins."""
    most: int
    window: timedelta
    is_own: bool = True
    """Whether a right password resets the count: it has no other account's attempts."""


@contextmanager
def attempting(storage: Storage, attempt: SignInAttempt, now: datetime) -> Iterator[None]:
    """Context of checking a password: TooOftenError above a limit; a SignInError counts as wrong."""
    limits = _limits(attempt)
    with storage.database.writing() as store:
        Attempts(store).forget_old(now)
        # One that is refused here does not count against the bounds behind it, or one address could use them up.
        exceeded = next((b for b in limits if Attempts(store).count(b.key, b.window, now) > b.most), None)
    if exceeded is not None:
        raise TooOftenError(TOO_OFTEN if exceeded.window == MINUTE else ENOUGH_TODAY)
    is_wrong = False
    try:
        yield
    except SignInError:
        is_wrong = True
        raise
    finally:
        if not is_wrong:
            _reset(storage, limits)


def _limits(attempt: SignInAttempt) -> tuple[_Limit, ...]:
    """Always in the same order, the narrowest first, so that no two requests wait for each other."""
    login = attempt.login.strip().lower()
    if attempt.browser:
        parts = ("browser", attempt.browser, login)
        return _Limit(_key("minute", *parts), LOGIN_LIMIT, MINUTE), _Limit(_key("day", *parts), DAILY_LIMIT, DAY)
    parts = ("address", attempt.address, login)
    return (
        _Limit(_key("address", attempt.address), ADDRESS_LIMIT, MINUTE, is_own=False),
        _Limit(_key("minute", *parts), LOGIN_LIMIT, MINUTE),
        _Limit(_key("day", *parts), DAILY_LIMIT, DAY),
        _Limit(_key("login", login), DAILY_LIMIT_OF_ALL, DAY, is_own=False),
    )


def _key(*parts: str) -> str:
    return sha256("\n".join(parts).encode()).hexdigest()


def _reset(storage: Storage, limits: tuple[_Limit, ...]) -> None:
    """Resets own counts after a right password, and subtracts this attempt from shared ones."""
    with storage.database.writing() as store:
        for limit in limits:
            if limit.is_own:
                Attempts(store).forget(limit.key)
            else:
                Attempts(store).take_back(limit.key)


SIGN_IN_LIFETIME = timedelta(hours=12)
"""Lifetime of a sign-in: a shift."""
WRONG = "Login or password is wrong, or the account may no longer sign in."
"""Does not state which, so that nobody learns who has an account."""


def sign_in(storage: Storage, login: str, password: str, now: datetime) -> str:
    """The secret of the browser; SignInError for a wrong password."""
    with storage.database.reading() as store:
        stored = Accounts(store).password_hash(login)
    if not is_password(stored, password):
        raise SignInError(WRONG)
    with storage.database.writing() as store:
        return begin(store, Accounts(store).get(login), now)


def begin(store: Store, account: Account, now: datetime, elsewhere: str = "") -> str:
    """Signs a browser in, within the transaction that admitted it; ``elsewhere``: the provider that did."""
    secret = new_secret()
    SignIns(store).add(account, stored_hash(secret), now, now + SIGN_IN_LIFETIME)
    Audit(store).write(now, account.name, "sign in", account.login, {"issuer": elsewhere} if elsewhere else {})
    return secret


def sign_out(storage: Storage, secret: str, now: datetime) -> None:
    """Invalidates the secret."""
    with storage.database.writing() as store:
        account = SignIns(store).shown(stored_hash(secret), now)
        if account is not None:
            Audit(store).write(now, account.name, "sign out", account.login, {})
        SignIns(store).end(stored_hash(secret))


LINK_LIFETIME = timedelta(hours=1)
"""Lifetime of a link; its owner is present."""
SPENT = (
    "This link was used already, or its hour is over. Ask an administrator for another; "
    "while there is no account, start the service again."
)


@dataclass(frozen=True)
class LinkForm:
    """The form behind a sign-in link."""

    login: str
    """Login, for the first account only."""
    name: str
    password: str


def make_link(storage: Storage, login: str | None, now: datetime, who: str) -> str:
    """The secret of a new link for an account, or, without a login, for the first account."""
    with storage.database.writing() as store:
        account = None if login is None else Accounts(store).get(login)
        if account is None and Accounts(store).any():
            raise ConflictError("There are accounts already: name the one that the link is for.")
        secret = new_secret()
        SignIns(store).add_link(account, stored_hash(secret), now, now + LINK_LIFETIME)
        Audit(store).write(now, who, "sign-in link", account.login if account else "the first account", {})
        return secret


def link_of(storage: Storage, secret: str, now: datetime) -> Account | None:
    """The account of a link, None for the first account; SignInError for an invalid one."""
    with storage.database.reading() as store:
        return _owner(store, secret, now)


def use_link(storage: Storage, secret: str, chosen: LinkForm, now: datetime) -> str:
    """Sets the password, ends existing access, signs in, and returns the secret of the browser."""
    with storage.database.reading() as store:
        owner = _owner(store, secret, now)
        stored = None if owner is None else Accounts(store).password_hash(owner.login)
    require_new_password(stored, chosen.password)
    new_hash = hashed(chosen.password)
    with storage.database.writing() as store:
        owner = _owner(store, secret, now)
        if not SignIns(store).use_link(stored_hash(secret), now):
            raise SignInError(SPENT)
        login = _first(store, chosen, now) if owner is None else owner.login
        Accounts(store).put_password_hash(login, new_hash)
        account = Accounts(store).get(login)
        Audit(store).write(now, account.name, "password", login, end_access(store, account, now))
        return begin(store, account, now)


def _owner(store: Store, secret: str, now: datetime) -> Account | None:
    is_valid, owner = SignIns(store).link(stored_hash(secret), now)
    if not is_valid or (owner is None and Accounts(store).any()) or (owner is not None and not owner.is_active):
        raise SignInError(SPENT)
    return owner


def _first(store: Store, chosen: LinkForm, now: datetime) -> str:
    """The account of the person who set the service up."""
    login = require_login(chosen.login)
    name = require_name("name", chosen.name) or login
    if not Accounts(store).add(login, name, Role.ADMIN, now):
        raise SignInError(SPENT)  # another link made it at the same moment: its password is not ours to set
    Audit(store).write(now, name, "add account", login, {"name": name, "role": Role.ADMIN})
    return login


LONGEST = timedelta(days=366)
"""Longest lifetime of a token: a forgotten one should end by itself."""


OUTLIVES = "A token cannot make tokens or sign-in links, which would outlive it: sign in with a browser."
OTHERS = "This token is another account's."
NOT_ITSELF = "A token can revoke only itself: sign in with a browser."


def require_no_token(person: Person) -> None:
    """ForbiddenError where a token requests access that outlives it."""
    if person.token:
        raise ForbiddenError(OUTLIVES)


def _require_may_revoke(person: Person, token: Token) -> None:
    """ForbiddenError unless a token is the person's own, or an administrator asks; a token revokes only itself."""
    if token.login != person.login and not person.may(Role.ADMIN):
        raise ForbiddenError(OTHERS)
    if person.token and person.token_id != token.id:
        raise ForbiddenError(NOT_ITSELF)


def make_token(
    storage: Storage, login: str, label: str, role: Role, now: datetime, *, lifetime: timedelta, who: str
) -> tuple[Token, str]:
    """A token for an account with its secret, which is not stored; its role is at most that of its account."""
    if not timedelta(0) < lifetime <= LONGEST:
        fault = problem_at("days", "must be from 1 to {days}", days=LONGEST.days)
        raise RefusedError("The token cannot be made.", (fault,))
    secret = TOKEN_PREFIX + new_secret()
    with storage.database.writing() as store:
        account = Accounts(store).get(login)
        if not account.is_active or not account.role.may(role):
            parts = {"login": account.login, "role": account.role, "wanted_role": role}
            raise ConflictError("{login} is {role} and cannot have a token for {wanted_role}.", **parts)
        new = Token(0, account.login, require_name("label", label) or "token", role, now, now + lifetime, None, None)
        token = Tokens(store).add(account, new, stored_hash(secret))
        details = {"token": token.id, "label": token.label, "role": role, "until": token.expires_at.isoformat()}
        Audit(store).write(now, who, "make token", account.login, details)
    return token, secret


def revoke_token(storage: Storage, id: int, person: Person, now: datetime, *, who: str) -> Token:
    """Revokes a token, where the person may; again it changes nothing."""
    with storage.database.writing() as store:
        token = Tokens(store).get(id)
        _require_may_revoke(person, token)
        if token.revoked_at is None:
            Tokens(store).revoke(id, now)
            Audit(store).write(now, who, "revoke token", token.login, {"token": id, "label": token.label})
        return Tokens(store).get(id)
