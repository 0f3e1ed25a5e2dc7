"""HEAD wherever GET is: the same status and headers, without the body."""

from starlette.types import ASGIApp, Message, Receive, Scope, Send


class HeadAsGet:
    """Works out what GET would answer (RFC 9110, 9.3.2); the server, whose own scope says HEAD, sends the head only."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything else through."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self.app(scope, receive, send)
            return
        asked = {**scope, "method": "GET"}

        async def named(message: Message) -> None:
            if "route" in asked:
                scope["route"] = asked["route"]  # which the log and the figures name
            await send(message)

        await self.app(asked, receive, named)
