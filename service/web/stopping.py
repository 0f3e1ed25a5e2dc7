"""A stop that loses nothing: who is inside finishes, who comes after is asked to come back."""

import asyncio
from dataclasses import dataclass

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.web.problems import problem

STOPPING = "The service is stopping. Nothing was stored; send this again in a few seconds."
RETRY_AFTER = 5
"""Seconds: about what a restart takes."""
GLANCE = 0.05
"""Seconds between two looks at who is still inside."""
STILL_ANSWERED = frozenset({"/healthz"})
"""The process is alive until it is gone."""


@dataclass
class Door:
    """Who is inside, and whether anybody is let in."""

    inside: int = 0
    closed: bool = False

    async def empty(self, within: float) -> None:
        """Lets nobody in any more, and waits until the last one has left, or for so many seconds."""
        self.closed = True
        loop = asyncio.get_running_loop()
        end = loop.time() + within
        while self.inside and loop.time() < end:
            await asyncio.sleep(GLANCE)


class Doorkeeper:
    """Counts the requests that are being answered, and lets none in once the service stops."""

    def __init__(self, app: ASGIApp, door: Door) -> None:
        self.app = app
        self.door = door

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """A request is inside until the end of its answer is sent; what then runs after it is made up for later."""
        if scope["type"] != "http" or scope["path"] in STILL_ANSWERED:
            await self.app(scope, receive, send)
        elif self.door.closed:
            headers = {"Retry-After": str(RETRY_AFTER), "Connection": "close"}
            await problem(503, STOPPING, headers=headers)(scope, receive, send)
        else:
            await self._inside(scope, receive, send)

    async def _inside(self, scope: Scope, receive: Receive, send: Send) -> None:
        left = False

        def leave() -> None:
            nonlocal left
            self.door.inside -= not left
            left = True

        async def noted(message: Message) -> None:
            await send(message)
            if message["type"] == "http.response.body" and not message.get("more_body"):
                leave()

        self.door.inside += 1
        try:
            await self.app(scope, receive, noted)
        finally:
            leave()
