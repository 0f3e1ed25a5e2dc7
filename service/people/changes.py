"""Accounts, passwords, sign-in links and tokens are made and changed; accounts are never deleted.

By account and address together, so that whoever guesses keeps out nobody but those at the same address; by address, so
that trying one password on everybody does not get far; by account, far more slowly, so that many addresses do not
either. A browser that has signed in to the account before has a count of its own and passes whatever others do. Counted
in the database, before the password is looked at: many processes, or many requests at once, get no more than one.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from hashlib import sha256

from estimator.errors import Problem
from estimator.message import say
from service.errors import ConflictError, ForbiddenError, RefusedError, SignInError, TooOftenError
from service.kit.person import Account, Person, Role, Token
from service.people.secret import TOKEN_PREFIX, fault_of, hashed, is_password, new_secret, stored_hash
from service.people.store import Accounts, Attempts, SignIns, Tokens
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store

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
        if not Accounts(store).any() and role is not Role.ADMIN:
            raise ConflictError("The first account must be an admin: from then on everybody has to sign in.")
        shown = name.strip() or small
        if not Accounts(store).add(small, shown, role, now):
            raise ConflictError(say("There is an account {small} already.", small=repr(small)))
        Audit(store).write(now, who, "add account", small, {"name": shown, "role": role})
        return Accounts(store).get(small)


def change_account(storage: Storage, login: str, change: AccountChange, now: datetime, *, who: str) -> Account:
    """Another name or role; or the account may no longer sign in, which ends browsers, links and tokens for good."""
    with storage.database.writing() as store:
        Accounts(store).hold_admins()
        was = Accounts(store).get(login)
        name = was.name if change.name is None else change.name.strip() or was.login
        role = was.role if change.role is None else change.role
        is_active = was.is_active if change.is_active is None else change.is_active
        loses = was.role is Role.ADMIN and was.is_active and not (role is Role.ADMIN and is_active)
        if loses and Accounts(store).admins() == 1:
            raise ConflictError(LAST_ADMIN)
        Accounts(store).put(was.login, name=name, role=role, is_active=is_active)
        ended = {} if is_active and was.is_active else end_access(store, was, now)
        found = Accounts(store).get(was.login)
        if found != was:
            details = {"before": _plain(was), "after": _plain(found), **ended}
            Audit(store).write(now, who, "change account", was.login, details)
        return found


def change_password(storage: Storage, login: str, old: str, new: str, now: datetime) -> None:
    """Another password, with the old one as proof; ends every browser, link and token of the account."""
    with storage.database.reading() as store:
        stored = Accounts(store).password_hash(login)
    if not is_password(stored, old):
        raise SignInError("The old password is wrong.")
    require_new_password(stored, new)
    replacing = hashed(new)
    with storage.database.writing() as store:
        account = Accounts(store).get(login)
        Accounts(store).put_password_hash(login, replacing)
        ended = end_access(store, account, now)
        Audit(store).write(now, account.name, "password", account.login, ended)


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
    SignIns(store).end_all(account)
    SignIns(store).end_links(account)
    revoked = Tokens(store).revoke_all(account, now)
    return {"tokens": list(revoked)} if revoked else {}


def _plain(account: Account) -> dict[str, object]:
    return {"name": account.name, "role": account.role, "is_active": account.is_active}


MINUTE, DAY = timedelta(minutes=1), timedelta(days=1)
BY_LOGIN, BY_ADDRESS = 5, 20
"""Wrong attempts within a minute: who knows a password mistypes it once or twice; several people share an address."""
A_DAY = 20
"""Wrong attempts a day at one account from one address, or from one browser that it knows."""
FROM_EVERYWHERE = 100
"""Wrong attempts a day at one account from all browsers that it does not know: of a million common passwords, however
many addresses try them, 0.01 % a day."""
TOO_OFTEN = "Too many wrong attempts. Wait a minute, then try again."
ENOUGH_TODAY = (
    "Too many wrong attempts today. Try again tomorrow, from a browser that has signed in to this account before, "
    "or ask an administrator for a link."
)


@dataclass(frozen=True)
class Attempt:
    """Somebody tries a password."""

    login: str
    address: str
    """That the request came from."""
    browser: str = ""
    """Of one that has signed in to this account before, its identifier; empty of any other."""


@dataclass(frozen=True)
class _Bound:
    """How many attempts may be wrong within a time."""

    key: str
    """What is counted: a hash, for people type passwords as logins too."""
    most: int
    window: timedelta
    is_own: bool = True
    """Whether a right password forgets all that were wrong before: nobody else's are counted there."""


@contextmanager
def attempting(storage: Storage, attempt: Attempt, now: datetime) -> Iterator[None]:
    """Around the look at the password: TooOftenError where there were too many, SignInError is a wrong one."""
    bounds = _bounds(attempt)
    with storage.database.writing() as store:
        Attempts(store).forget_old(now)
        # One that is refused here does not count against the bounds behind it, or one address could use them up.
        over = next((b for b in bounds if Attempts(store).count(b.key, b.window, now) > b.most), None)
    if over is not None:
        raise TooOftenError(TOO_OFTEN if over.window == MINUTE else ENOUGH_TODAY)
    is_wrong = False
    try:
        yield
    except SignInError:
        is_wrong = True
        raise
    finally:
        if not is_wrong:
            _forgive(storage, bounds)


def _bounds(attempt: Attempt) -> tuple[_Bound, ...]:
    """Always in the same order, the narrowest first, so that no two requests wait for each other."""
    login = attempt.login.strip().lower()
    if attempt.browser:
        own = ("browser", attempt.browser, login)
        return _Bound(_key("minute", *own), BY_LOGIN, MINUTE), _Bound(_key("day", *own), A_DAY, DAY)
    own = ("address", attempt.address, login)
    return (
        _Bound(_key("address", attempt.address), BY_ADDRESS, MINUTE, is_own=False),
        _Bound(_key("minute", *own), BY_LOGIN, MINUTE),
        _Bound(_key("day", *own), A_DAY, DAY),
        _Bound(_key("login", login), FROM_EVERYWHERE, DAY, is_own=False),
    )


def _key(*parts: str) -> str:
    return sha256("\n".join(parts).encode()).hexdigest()


def _forgive(storage: Storage, bounds: tuple[_Bound, ...]) -> None:
    """It was right: what was tried before from here is forgotten, and this one where others are counted too."""
    with storage.database.writing() as store:
        for bound in bounds:
            if bound.is_own:
                Attempts(store).forget(bound.key)
            else:
                Attempts(store).take_back(bound.key)


LASTS = timedelta(hours=12)
"""That a browser stays signed in: a shift."""
WRONG = "Login or password is wrong, or the account may no longer sign in."
"""Says not which, so that nobody learns who has an account."""


def sign_in(storage: Storage, login: str, password: str, now: datetime) -> str:
    """The secret that the browser shows from now on; SignInError where the password is wrong."""
    with storage.database.reading() as store:
        stored = Accounts(store).password_hash(login)
    if not is_password(stored, password):
        raise SignInError(WRONG)
    with storage.database.writing() as store:
        return begin(store, Accounts(store).get(login), now)


def begin(store: Store, account: Account, now: datetime, elsewhere: str = "") -> str:
    """Signs a browser in, within the transaction that let somebody in; ``elsewhere``: the provider that did."""
    secret = new_secret()
    SignIns(store).add(account, stored_hash(secret), now, now + LASTS)
    Audit(store).write(now, account.name, "sign in", account.login, {"issuer": elsewhere} if elsewhere else {})
    return secret


def sign_out(storage: Storage, secret: str, now: datetime) -> None:
    """The secret is worth nothing from now on."""
    with storage.database.writing() as store:
        account = SignIns(store).shown(stored_hash(secret), now)
        if account is not None:
            Audit(store).write(now, account.name, "sign out", account.login, {})
        SignIns(store).end(stored_hash(secret))


HOLDS = timedelta(hours=1)
"""That a link can be used; the one who asked for it is at hand."""
SPENT = (
    "This link was used already, or its hour is over. Ask an administrator for another; "
    "while there is no account, start the service again."
)


@dataclass(frozen=True)
class Chosen:
    """What somebody fills in who opened a link."""

    login: str
    """Only of the first account; others have theirs."""
    name: str
    password: str


def make_link(storage: Storage, login: str | None, now: datetime, who: str) -> str:
    """The secret of a new link for an account, or, without a login, for the first account of all."""
    with storage.database.writing() as store:
        account = None if login is None else Accounts(store).get(login)
        if account is None and Accounts(store).any():
            raise ConflictError("There are accounts already: name the one that the link is for.")
        secret = new_secret()
        SignIns(store).add_link(account, stored_hash(secret), now, now + HOLDS)
        Audit(store).write(now, who, "sign-in link", account.login if account else "the first account", {})
        return secret


def link_of(storage: Storage, secret: str, now: datetime) -> Account | None:
    """Whom a link signs in, None for the first account of all; SignInError where it holds no longer."""
    with storage.database.reading() as store:
        return _owner(store, secret, now)


def use_link(storage: Storage, secret: str, chosen: Chosen, now: datetime) -> str:
    """Sets the password, ends what the account had open, signs in, and returns what the browser shows from now on."""
    with storage.database.reading() as store:
        owner = _owner(store, secret, now)
        stored = None if owner is None else Accounts(store).password_hash(owner.login)
    require_new_password(stored, chosen.password)
    replacing = hashed(chosen.password)
    with storage.database.writing() as store:
        owner = _owner(store, secret, now)
        if not SignIns(store).use_link(stored_hash(secret), now):
            raise SignInError(SPENT)
        login = _first(store, chosen, now) if owner is None else owner.login
        Accounts(store).put_password_hash(login, replacing)
        account = Accounts(store).get(login)
        Audit(store).write(now, account.name, "password", login, end_access(store, account, now))
        return begin(store, account, now)


def _owner(store: Store, secret: str, now: datetime) -> Account | None:
    holds, owner = SignIns(store).link(stored_hash(secret), now)
    if not holds or (owner is None and Accounts(store).any()) or (owner is not None and not owner.is_active):
        raise SignInError(SPENT)
    return owner


def _first(store: Store, chosen: Chosen, now: datetime) -> str:
    """The account of the one who set the service up."""
    login = require_login(chosen.login)
    name = chosen.name.strip() or login
    if not Accounts(store).add(login, name, Role.ADMIN, now):
        raise SignInError(SPENT)  # another link made it at the same moment: its password is not ours to set
    Audit(store).write(now, name, "add account", login, {"name": name, "role": Role.ADMIN})
    return login


LONGEST = timedelta(days=366)
"""That a token may hold: what nobody remembers should end by itself."""


OUTLIVES = "A token makes no tokens and no sign-in links, which would outlive it: sign in with a browser."
OTHERS = "This token is another account's."
NOT_ITSELF = "A token revokes none but itself: sign in with a browser."


def require_no_token(person: Person) -> None:
    """ForbiddenError where a token asks for something that lets somebody in for longer than the token does."""
    if person.token:
        raise ForbiddenError(OUTLIVES)


def require_may_revoke(person: Person, token: Token) -> None:
    """ForbiddenError unless a token is somebody's own, or an administrator asks; a token revokes only itself."""
    if token.login != person.login and not person.may(Role.ADMIN):
        raise ForbiddenError(OTHERS)
    if person.token and person.token_id != token.id:
        raise ForbiddenError(NOT_ITSELF)


def make_token(
    storage: Storage, login: str, label: str, role: Role, now: datetime, *, lasts: timedelta, who: str
) -> tuple[Token, str]:
    """A token for an account with the secret to show, which is not kept; it may do at most what its account may."""
    if not timedelta(0) < lasts <= LONGEST:
        fault = Problem("days", say("must be from 1 to {days}", days=LONGEST.days))
        raise RefusedError("The token cannot be made.", (fault,))
    secret = TOKEN_PREFIX + new_secret()
    with storage.database.writing() as store:
        account = Accounts(store).get(login)
        if not account.is_active or not account.role.may(role):
            raise ConflictError(
                say(
                    "{login} is {role} and cannot have a token for {wanted_role}.",
                    login=account.login,
                    role=account.role,
                    wanted_role=role,
                )
            )
        new = Token(0, account.login, label.strip() or "token", role, now, now + lasts, None, None)
        token = Tokens(store).add(account, new, stored_hash(secret))
        details = {"token": token.id, "label": token.label, "role": role, "until": token.expires_at.isoformat()}
        Audit(store).write(now, who, "make token", account.login, details)
    return token, secret


def revoke_token(storage: Storage, id: int, now: datetime, *, who: str) -> Token:
    """Nobody gets in with it any more; again it changes nothing."""
    with storage.database.writing() as store:
        token = Tokens(store).get(id)
        if token.revoked_at is None:
            Tokens(store).revoke(id, now)
            Audit(store).write(now, who, "revoke token", token.login, {"token": id, "label": token.label})
        return Tokens(store).get(id)
