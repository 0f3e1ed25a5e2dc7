"""Cacheable answers: each has a tag of its content, and is not sent again to a caller that has it."""

from hashlib import sha256

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

OK, NOT_MODIFIED = 200, 304
CACHE_CONTROL = "private, no-cache"
"""May be cached by the caller, and must be revalidated before use."""
HEADERS_OF_304 = ("etag", "cache-control", "vary")
"""Headers of an answer without content (RFC 9110, 15.4.5)."""


class EntityTags:
    """Tags every complete answer to GET below a prefix that has no tag of its own."""

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
    """Whether it has status 200 and no tag."""
    return start["status"] == OK and "etag" not in MutableHeaders(scope=start)


def _answer(start: Message, whole: Message, known: str) -> tuple[Message, Message]:
    """The answer with its tag, or 304 where the caller has it.

    The tag is weak: the answer may be compressed in transit.
    """
    headers = MutableHeaders(scope=start)
    tag_value = f'"{sha256(whole["body"]).hexdigest()[:32]}"'
    headers["ETag"] = f"W/{tag_value}"
    headers.setdefault("Cache-Control", CACHE_CONTROL)
    if tag_value not in known and known.strip() != "*":
        return start, whole
    headers_left = [(name, value) for name, value in start["headers"] if name.decode() in HEADERS_OF_304]
    return {**start, "status": NOT_MODIFIED, "headers": headers_left}, {**whole, "body": b""}
