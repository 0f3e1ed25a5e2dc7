"""How large the body of a request may be, and how slowly it may come.

Bodies of uploads have limits of their own, where they are received. Any other body is a few fields: what announces
more is refused before it is read, what turns out to be more as soon as it is. The time that counts is the client's
alone: while the service works, nobody waits for the client.
"""

import asyncio
from dataclasses import dataclass

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from estimator.message import say
from service.web.headers import API as PREFIX
from service.web.problems import problem

UPLOADS = frozenset(
    {
        f"{PREFIX}/sessions",
        f"{PREFIX}/layouts/preview",
        f"{PREFIX}/plan/missing",
        f"{PREFIX}/plan/ready",
        f"{PREFIX}/attachments",
        "/upload",
        "/upload/layout",
        "/attachments",
        "/ready",
        "/missing",
    }
)
"""Where files are received; these routes count what comes themselves."""
TOO_LARGE, TOO_SLOW = 413, 408
SLOWEST = 4000
"""Bytes a second: a sixth of what a mobile line of the second generation (EDGE) carries."""
LATE = 1.0
"""Seconds: a clock that goes off later than this was held up by the service itself, and blames no client."""
CLOSE = {"Connection": "close"}
"""With the answer to a body that does not come. What is too large comes and is passed over: a connection that is
closed before would take the answer with it."""


class Unfinished(HTTPException):
    """A body that is too large or too slow; whoever reads it passes this on, as FastAPI does."""


@dataclass(frozen=True)
class Limits:
    """What a body may take."""

    most: int
    """Bytes, except of uploads."""
    patience: float
    """Seconds that the client may keep the service waiting, beside what a slow line needs."""


class LimitedBodies:
    """Stops bodies that grow too large or come too slowly."""

    def __init__(self, app: ASGIApp, limits: Limits) -> None:
        self.app = app
        self.limits = limits

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuses what announces too much; the rest is watched while it is read."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        most = None if scope["path"] in UPLOADS else self.limits.most
        if most is not None and _announced(scope) > most:
            await _answer(_too_large(most))(scope, receive, send)
            return
        body = _Body(receive, send, most, self.limits.patience)
        try:
            await self.app(scope, body.receive, body.send)
        except Unfinished as fault:  # by whoever reads a body outside of the routes
            if body.answered:
                raise
            await _answer(fault)(scope, receive, send)


class _Body:
    """One body on its way in: how much came, and for how long it was waited for."""

    def __init__(self, receive: Receive, send: Send, most: int | None, patience: float) -> None:
        self._receive, self._send, self._most = receive, send, most
        self._patience = patience
        self._came, self._waited, self._complete = 0, 0.0, False
        self.answered = False

    async def send(self, message: Message) -> None:
        """Notes that the answer has begun: from then on a body matters to nobody."""
        self.answered = True
        await self._send(message)

    async def receive(self) -> Message:
        """The next part; `Unfinished` where there is too much of it, or where it does not come."""
        if self._complete or self.answered:
            return await self._receive()
        message = await self._in_time()
        self._came += len(message.get("body", b""))
        self._complete = not message.get("more_body", False)
        if self._most is not None and self._came > self._most:
            raise _too_large(self._most)
        return message

    async def _in_time(self) -> Message:
        loop = asyncio.get_running_loop()
        start = loop.time()
        left = self._patience + self._came / SLOWEST - self._waited
        while True:
            end = loop.time() + max(left, 0.0)
            try:
                async with asyncio.timeout_at(end):
                    message = await self._receive()
                break
            except TimeoutError:
                if loop.time() - end < LATE:
                    raise Unfinished(TOO_SLOW, _slow(self._patience), CLOSE) from None
                left = LATE  # It was the service that was late: what came meanwhile is still to be looked at.
        self._waited += loop.time() - start
        return message


def _announced(scope: Scope) -> int:
    """The length that a request gives itself; the server has made sure that it is a number."""
    return int(Headers(scope=scope).get("content-length", "0"))


def _too_large(most: int) -> Unfinished:
    return Unfinished(
        TOO_LARGE, say("A request of this kind may hold {most} bytes; this one is larger.", most=f"{most:,}")
    )


def _slow(patience: float) -> str:
    return say(
        "The request did not arrive within {patience} s more than a slow line needs.",
        patience=f"{patience:g}",
    )


def _answer(fault: Unfinished) -> ASGIApp:
    return problem(fault.status_code, fault.detail, headers=fault.headers)
