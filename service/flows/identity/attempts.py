"""Flow: how often somebody may try a password: by login and by address, so that neither guessing one password nor
trying one password on everybody gets far. Counted in the database, before the password is looked at: many processes,
or many requests at once, get no more than one."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from hashlib import sha256

from service.errors import SignInError, TooOftenError
from service.storage import Storage

BY_LOGIN, BY_ADDRESS = 5, 20
"""Wrong attempts within a minute: who knows a password mistypes it once or twice; several people share an address."""
TOO_OFTEN = "Too many wrong attempts. Wait a minute, then try again."


@dataclass(frozen=True)
class Attempt:
    """Somebody tries a password."""

    login: str
    address: str
    """That the request came from."""

    @property
    def keys(self) -> tuple[str, str]:
        """What is counted of the login and of the address: hashes, for people type passwords as logins too."""
        login, address = f"login {self.login.strip().lower()}", f"address {self.address}"
        return sha256(login.encode()).hexdigest(), sha256(address.encode()).hexdigest()


@contextmanager
def attempting(storage: Storage, attempt: Attempt, now: datetime) -> Iterator[None]:
    """Around the look at the password: TooOftenError where there were too many, SignInError is a wrong one."""
    login, address = attempt.keys
    with storage.database.writing() as store:
        store.attempts.forget_old(now)
        counts = store.attempts.count(login, now), store.attempts.count(address, now)
    if counts[0] > BY_LOGIN or counts[1] > BY_ADDRESS:
        raise TooOftenError(TOO_OFTEN)
    is_wrong = False
    try:
        yield
    except SignInError:
        is_wrong = True
        raise
    finally:
        if not is_wrong:
            _forgive(storage, attempt)


def _forgive(storage: Storage, attempt: Attempt) -> None:
    """It was right: what was tried before at this login is forgotten, and this one at the address."""
    login, address = attempt.keys
    with storage.database.writing() as store:
        store.attempts.forget(login)
        store.attempts.take_back(address)
