"""Turns at costly work: few requests do it at once, some wait without holding a thread, and others come again."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import Request

from service.errors import BusyError
from service.web.application import application_of


class Turns:
    """Turns, first come, first served. Used by the event loop alone."""

    at_once: int
    most_waiting: int
    """Requests that wait for a turn: the last of them for a few seconds."""
    busy: str
    """The answer to those beyond."""

    def __init__(self) -> None:
        self._free, self._inside = asyncio.Semaphore(self.at_once), 0

    @asynccontextmanager
    async def one(self) -> AsyncIterator[None]:
        """A turn; BusyError where too many wait for one."""
        if self._inside >= self.at_once + self.most_waiting:
            raise BusyError(self.busy)
        self._inside += 1
        try:
            async with self._free:
                yield
        finally:
            self._inside -= 1


class PasswordTurns(Turns):
    """Turns at hashing a password, which takes 64 MiB and some cores on purpose."""

    at_once = 2
    most_waiting = 8
    busy = "Many people are signing in at this moment. Try again in a few seconds."


class RegisterTurns(Turns):
    """Turns at entering a register, which writes for several seconds, in pieces."""

    at_once = 1
    most_waiting = 3
    busy = (
        "Other registers are being entered at this moment; nothing of this one was stored. Send it again in a minute."
    )


async def password_turn(request: Request) -> AsyncIterator[None]:
    """Dependency: a turn at hashing a password."""
    async with application_of(request).part(PasswordTurns).one():
        yield


async def register_turn(request: Request) -> AsyncIterator[None]:
    """Dependency: a turn at entering a register."""
    async with application_of(request).part(RegisterTurns).one():
        yield
