"""Turns at passwords: hashing one takes 64 MiB and some cores on purpose, so few are hashed at once."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from service.errors import BusyError

AT_ONCE = 2
MOST_WAITING = 8
"""They wait a second at most; whoever comes then comes again."""
BUSY = "Many people are signing in at this moment. Try again in a few seconds."


class PasswordTurns:
    """Turns, first come, first served. Used by the event loop alone, so that nobody who waits holds a thread."""

    def __init__(self) -> None:
        self._free, self._inside = asyncio.Semaphore(AT_ONCE), 0

    @asynccontextmanager
    async def one(self) -> AsyncIterator[None]:
        """A turn; BusyError where too many wait for one."""
        if self._inside >= AT_ONCE + MOST_WAITING:
            raise BusyError(BUSY)
        self._inside += 1
        try:
            async with self._free:
                yield
        finally:
            self._inside -= 1
