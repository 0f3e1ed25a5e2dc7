"""Flow: how often somebody may try a password.

By account and address together, so that whoever guesses keeps out nobody but those at the same address; by address, so
that trying one password on everybody does not get far; by account, far more slowly, so that many addresses do not
either. A browser that has signed in to the account before has a count of its own and passes whatever others do. Counted
in the database, before the password is looked at: many processes, or many requests at once, get no more than one.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from hashlib import sha256

from service.errors import SignInError, TooOftenError
from service.storage import Storage

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
        store.attempts.forget_old(now)
        # One that is refused here does not count against the bounds behind it, or one address could use them up.
        over = next((b for b in bounds if store.attempts.count(b.key, b.window, now) > b.most), None)
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
                store.attempts.forget(bound.key)
            else:
                store.attempts.take_back(bound.key)
