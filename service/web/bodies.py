"""Limits of size and time for the body of a request.

Bodies of uploads have limits of their own, where they are received. Any other body is a few fields: one that announces
more is refused before it is read, one that turns out to be more as soon as it is. Only the time of the client counts,
not that of the service.
"""

import asyncio
from dataclasses import dataclass
from pathlib import Path

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from estimator.message import say
from service.kit.log import log
from service.storage.folders import space_at
from service.web.headers import API as PREFIX
from service.web.problems import problem

UPLOADS = frozenset(
    {
        f"{PREFIX}/sessions",
        f"{PREFIX}/layouts/preview",
        f"{PREFIX}/plan/missing",
        f"{PREFIX}/plan/ready",
        f"{PREFIX}/attachments",
        f"{PREFIX}/register",
        "/upload",
        "/upload/layout",
        "/attachments",
        "/register/import",
    }
)
"""Routes that receive files; they limit the size themselves."""
TOO_LARGE, TOO_SLOW = 413, 408
SLOWEST = 4000
"""Bytes a second: a sixth of the rate of a second-generation mobile line (EDGE)."""
LATE_SECONDS = 1.0
"""Seconds: a timeout later than this was delayed by the service itself, and is not the client's fault."""
CLOSE = {"Connection": "close"}
"""Header of the answer to a body that does not arrive. A body that is too large is read and discarded: closing the
connection before would lose the answer.
"""


class Unfinished(HTTPException):
    """A body that is too large or too slow; passed on by its reader, as FastAPI does."""


@dataclass(frozen=True)
class BodyLimits:
    """Limits of a body."""

    most: int
    """Bytes, except of uploads."""
    patience: float
    """Seconds that the client may keep the service waiting, besides the time of a slow line."""


class LimitedBodies:
    """Stops bodies that are too large or too slow."""

    def __init__(self, app: ASGIApp, limits: BodyLimits) -> None:
        self.app = app
        self.limits = limits

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuses a body that announces too much; counts the rest while it is read."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        limit = None if scope["path"] in UPLOADS else self.limits.most
        if limit is not None and int(Headers(scope=scope).get("content-length", "0")) > limit:
            await _answer(_too_large(limit))(scope, receive, send)
            return
        body = _Body(receive, send, limit, self.limits.patience)
        try:
            await self.app(scope, body.receive, body.send)
        except Unfinished as fault:  # by whoever reads a body outside of the routes
            if body.answered:
                raise
            await _answer(fault)(scope, receive, send)


class _Body:
    def __init__(self, receive: Receive, send: Send, limit: int | None, patience: float) -> None:
        self._receive, self._send, self._most = receive, send, limit
        self._patience = patience
        self._came, self._waited, self._complete = 0, 0.0, False
        self.answered = False

    async def send(self, message: Message) -> None:
        """Notes that the answer has begun: from then on the body no longer matters."""
        self.answered = True
        await self._send(message)

    async def receive(self) -> Message:
        """The next part; `Unfinished` where it exceeds the limit, or does not arrive."""
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
        remaining = self._patience + self._came / SLOWEST - self._waited
        while True:
            end = loop.time() + max(remaining, 0.0)
            try:
                async with asyncio.timeout_at(end):
                    message = await self._receive()
                break
            except TimeoutError:
                if loop.time() - end < LATE_SECONDS:
                    raise Unfinished(TOO_SLOW, _slow(self._patience), CLOSE) from None
                remaining = LATE_SECONDS  # The service was late, not the client: look for what came meanwhile.
        self._waited += loop.time() - start
        return message


def _too_large(limit: int) -> Unfinished:
    return Unfinished(
        TOO_LARGE, say("A request of this kind may hold {limit} bytes; this one is larger.", limit=f"{limit:,}")
    )


def _slow(patience: float) -> str:
    return say(
        "The request arrived too slowly: {patience} s after a slow line would have sent it, it was not complete.",
        patience=f"{patience:g}",
    )


def _answer(fault: Unfinished) -> ASGIApp:
    return problem(fault.status_code, fault.detail, headers=fault.headers)


FULL = 507


class RoomForUploads:
    """Checks the disk before an upload is read."""

    def __init__(self, app: ASGIApp, folder: Path, least: int) -> None:
        self.app = app
        self.folder, self.least = folder, least

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything but uploads without enough space."""
        if scope["type"] != "http" or scope["method"] != "POST" or scope["path"] not in UPLOADS:
            await self.app(scope, receive, send)
            return
        announced = int(Headers(scope=scope).get("content-length", "0"))
        space = await run_in_threadpool(space_at, self.folder, self.least + announced)
        if space.too_little is None:
            await self.app(scope, receive, send)
            return
        log.warning("upload refused for want of room", free=space.free, least=space.least)
        await problem(FULL, space.too_little)(scope, receive, send)
