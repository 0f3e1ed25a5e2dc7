"""Flow: somebody signs in with a password, and out again."""

from datetime import datetime, timedelta

from service.errors import SignInError
from service.identity.passwords import is_password
from service.identity.secret import new_secret, stored_hash
from service.records.identity import Account
from service.storage import Storage
from service.storage.store import Store

LASTS = timedelta(hours=12)
"""That a browser stays signed in: a shift."""
WRONG = "Login or password is wrong, or the account may no longer sign in."
"""Says not which, so that nobody learns who has an account."""


def sign_in(storage: Storage, login: str, password: str, now: datetime) -> str:
    """The secret that the browser shows from now on; SignInError where the password is wrong."""
    with storage.database.reading() as store:
        stored = store.accounts.password_hash(login)
    if not is_password(stored, password):
        raise SignInError(WRONG)
    with storage.database.writing() as store:
        return begin(store, store.accounts.get(login), now)


def begin(store: Store, account: Account, now: datetime, elsewhere: str = "") -> str:
    """Signs a browser in, within the transaction that let somebody in; ``elsewhere``: the provider that did."""
    secret = new_secret()
    store.sign_ins.add(account, stored_hash(secret), now, now + LASTS)
    store.audit.write(now, account.name, "sign in", account.login, {"issuer": elsewhere} if elsewhere else {})
    return secret


def sign_out(storage: Storage, secret: str, now: datetime) -> None:
    """The secret is worth nothing from now on."""
    with storage.database.writing() as store:
        account = store.sign_ins.shown(stored_hash(secret), now)
        if account is not None:
            store.audit.write(now, account.name, "sign out", account.login, {})
        store.sign_ins.end(stored_hash(secret))
