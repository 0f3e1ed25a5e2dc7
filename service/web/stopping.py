"""A graceful stop: running requests finish, later ones are rejected with Retry-After."""

import asyncio
from dataclasses import dataclass

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.web.problems import problem

STOPPING = "The service is stopping. Nothing was stored; send this again in a few seconds."
RETRY_AFTER = 5
"""Seconds until a retry: about the time of a restart."""
POLL_SECONDS = 0.05
"""Seconds between two checks for running requests."""
STILL_ANSWERED = frozenset({"/healthz"})
"""The process is alive until it ends."""


@dataclass
class RequestGate:
    """Number of running requests, and whether new ones are accepted."""

    inside: int = 0
    closed: bool = False

    async def empty(self, within: float) -> None:
        """Rejects new requests, and waits for the running ones, or until the time limit."""
        self.closed = True
        loop = asyncio.get_running_loop()
        end = loop.time() + within
        while self.inside and loop.time() < end:
            await asyncio.sleep(POLL_SECONDS)


class GracefulStop:
    """Counts running requests, and rejects new ones once the service stops."""

    def __init__(self, app: ASGIApp, gate: RequestGate) -> None:
        self.app = app
        self.gate = gate

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """A request runs until the end of its answer is sent; background tasks are resumed at the next start."""
        if scope["type"] != "http" or scope["path"] in STILL_ANSWERED:
            await self.app(scope, receive, send)
        elif self.gate.closed:
            headers = {"Retry-After": str(RETRY_AFTER), "Connection": "close"}
            await problem(503, STOPPING, headers=headers)(scope, receive, send)
        else:
            await self._inside(scope, receive, send)

    async def _inside(self, scope: Scope, receive: Receive, send: Send) -> None:
        has_left = False

        def leave() -> None:
            nonlocal has_left
            self.gate.inside -= not has_left
            has_left = True

        async def counted(message: Message) -> None:
            await send(message)
            if message["type"] == "http.response.body" and not message.get("more_body"):
                leave()

        self.gate.inside += 1
        try:
            await self.app(scope, receive, counted)
        finally:
            leave()
