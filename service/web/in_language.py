"""Every answer that people read tells caches and browsers of its language."""

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.languages.language import COOKIE, YEAR, asked, chosen_by_query

READ_BY_PEOPLE = ("text/html", "application/problem+json")
"""Kinds of answers that depend on the language; all others are for programs, or their routes say it."""
PAPERS = ("application/pdf", "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet")
"""Made in the language of the one who asks, or kept in that of the one who approved them."""


class InOneLanguage:
    """Outside of everything that answers: errors of any part pass it."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything through, with the headers of its language."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        await self.app(scope, receive, _Speaker(scope, send))


class _Speaker:
    """Adds the headers of a language."""

    def __init__(self, scope: Scope, send: Send) -> None:
        self._send, self._language = send, asked(scope)
        self._by_hand = chosen_by_query(scope["query_string"].decode("latin-1"))

    async def __call__(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            kind = MutableHeaders(scope=message).get("content-type", "")
            if kind.startswith((*READ_BY_PEOPLE, *PAPERS)):
                self._tell(MutableHeaders(scope=message), kind)
        await self._send(message)

    def _tell(self, headers: MutableHeaders, kind: str) -> None:
        if kind.startswith(READ_BY_PEOPLE):
            headers.setdefault("Content-Language", self._language.value)
        headers.add_vary_header("Accept-Language")
        headers.add_vary_header("Cookie")
        if self._by_hand and kind.startswith("text/html"):
            headers.append(
                "Set-Cookie", f"{COOKIE}={self._by_hand.value}; Path=/; Max-Age={YEAR}; SameSite=Lax; HttpOnly"
            )
