"""Flow: a link that signs somebody in once and lets them choose a password; the first one makes the first account."""

from dataclasses import dataclass
from datetime import datetime, timedelta

from service.errors import ConflictError, SignInError
from service.flows.identity.accounts import end_access, require_login, require_new_password
from service.flows.identity.sign_in import begin
from service.identity.passwords import hashed
from service.identity.secret import new_secret, stored_hash
from service.records.identity import Account, Role
from service.storage import Storage
from service.storage.store import Store

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
        account = None if login is None else store.accounts.get(login)
        if account is None and store.accounts.any():
            raise ConflictError("There are accounts already: name the one that the link is for.")
        secret = new_secret()
        store.sign_ins.add_link(account, stored_hash(secret), now, now + HOLDS)
        store.audit.write(now, who, "sign-in link", account.login if account else "the first account", {})
        return secret


def link_of(storage: Storage, secret: str, now: datetime) -> Account | None:
    """Whom a link signs in, None for the first account of all; SignInError where it holds no longer."""
    with storage.database.reading() as store:
        return _owner(store, secret, now)


def use_link(storage: Storage, secret: str, chosen: Chosen, now: datetime) -> str:
    """Sets the password, ends what the account had open, signs in, and returns what the browser shows from now on."""
    with storage.database.reading() as store:
        owner = _owner(store, secret, now)
        stored = None if owner is None else store.accounts.password_hash(owner.login)
    require_new_password(stored, chosen.password)
    replacing = hashed(chosen.password)
    with storage.database.writing() as store:
        owner = _owner(store, secret, now)
        if not store.sign_ins.use_link(stored_hash(secret), now):
            raise SignInError(SPENT)
        login = _first(store, chosen, now) if owner is None else owner.login
        store.accounts.put_password_hash(login, replacing)
        account = store.accounts.get(login)
        store.audit.write(now, account.name, "password", login, end_access(store, account, now))
        return begin(store, account, now)


def _owner(store: Store, secret: str, now: datetime) -> Account | None:
    holds, owner = store.sign_ins.link(stored_hash(secret), now)
    if not holds or (owner is None and store.accounts.any()) or (owner is not None and not owner.is_active):
        raise SignInError(SPENT)
    return owner


def _first(store: Store, chosen: Chosen, now: datetime) -> str:
    """The account of the one who set the service up."""
    login = require_login(chosen.login)
    name = chosen.name.strip() or login
    if not store.accounts.add(login, name, Role.ADMIN, now):
        raise SignInError(SPENT)  # another link made it at the same moment: its password is not ours to set
    store.audit.write(now, name, "add account", login, {"name": name, "role": Role.ADMIN})
    return login
