"""How often somebody may try to sign in wrongly: by address and by login, so that neither guessing one password nor
trying one password on everybody gets far."""

from limits import RateLimitItem, parse
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter

from service.errors import TooOftenError

BY_LOGIN, BY_ADDRESS = parse("5 per minute"), parse("20 per minute")
"""Wrong attempts; of a process, so that n of them together allow n times as many."""
TOO_OFTEN = "Too many wrong attempts. Wait a minute, then try again."


class Attempts:
    """Wrong attempts of the last minute."""

    def __init__(self) -> None:
        self._limiter = MovingWindowRateLimiter(MemoryStorage())

    def require_few(self, login: str, address: str) -> None:
        """TooOftenError where there were too many."""
        if not all(self._limiter.test(limit, *keys) for limit, keys in _counted(login, address)):
            raise TooOftenError(TOO_OFTEN)

    def wrong(self, login: str, address: str) -> None:
        """Counts one."""
        for limit, keys in _counted(login, address):
            self._limiter.hit(limit, *keys)


def _counted(login: str, address: str) -> tuple[tuple[RateLimitItem, tuple[str, str]], ...]:
    return (BY_LOGIN, ("login", login.lower())), (BY_ADDRESS, ("address", address))
