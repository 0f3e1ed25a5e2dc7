"""Answers that a caller may hold: each has a tag of its content, and is not sent again to whoever has it."""

from hashlib import sha256

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

OK, NOT_MODIFIED = 200, 304
HELD = "private, no-cache"
"""It may be held by who asked for it, and is to be asked for again before it is used."""
KEPT = ("etag", "cache-control", "vary")
"""Headers that an answer without content still has (RFC 9110, 15.4.5)."""


class Held:
    """Tags every answer to GET below a prefix that comes in one piece and has no tag of its own."""

    def __init__(self, app: ASGIApp, prefix: str) -> None:
        self.app, self.prefix = app, f"{prefix}/"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Holds the head of an answer back until its content is known."""
        if scope["type"] != "http" or scope["method"] != "GET" or not scope["path"].startswith(self.prefix):
            await self.app(scope, receive, send)
            return
        known, waiting = Headers(scope=scope).get("if-none-match", ""), list[Message]()

        async def tagged(message: Message) -> None:
            if message["type"] == "http.response.start" and _is_plain(message):
                waiting.append(message)
                return
            if waiting:
                start = waiting.pop()
                if not message.get("more_body"):
                    start, message = _answer(start, message, known)
                await send(start)
            await send(message)

        await self.app(scope, receive, tagged)


def _is_plain(start: Message) -> bool:
    """Whether it says 200 and has no tag yet."""
    return start["status"] == OK and "etag" not in MutableHeaders(scope=start)


def _answer(start: Message, whole: Message, known: str) -> tuple[Message, Message]:
    """The answer with its tag, or that the caller has it already.

    The tag is weak: what is sent may be compressed on its way.
    """
    headers = MutableHeaders(scope=start)
    mark = f'"{sha256(whole["body"]).hexdigest()[:32]}"'
    headers["ETag"] = f"W/{mark}"
    headers.setdefault("Cache-Control", HELD)
    if mark not in known and known.strip() != "*":
        return start, whole
    kept = [(name, value) for name, value in start["headers"] if name.decode() in KEPT]
    return {**start, "status": NOT_MODIFIED, "headers": kept}, {**whole, "body": b""}
