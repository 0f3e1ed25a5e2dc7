"""Language of answers: templates, and headers for caches and browsers."""

from collections.abc import Mapping
from typing import Any

from markupsafe import Markup
from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.languages.catalogue import catalogue_of
from service.languages.language import COOKIE, YEAR, Language, asked, chosen_by_query
from service.languages.plain_text import OF_PEOPLE


class TemplateLanguage:
    """Translation of templates. English is the language of the sources, and is left alone."""

    def __init__(self, language: Language) -> None:
        self._catalogue = None if language is Language.ENGLISH else catalogue_of(language)

    def gettext(self, sentence: str, /, **values: Any) -> Markup:
        """A sentence of a template with its values."""
        return self._filled(sentence if self._catalogue is None else self._catalogue.form(sentence), values)

    def ngettext(self, singular: str, plural: str, number: int | str, /, **values: Any) -> Markup:
        """A sentence about a number of things, which may be written with commas between thousands."""
        count = int(str(number).replace(",", ""))
        if self._catalogue is None:
            return self._filled(singular if count == 1 else plural, values)
        return self._filled(self._catalogue.form(singular, count), values)

    def say(self, value: Any) -> Any:
        """A value of a page in the language; markup and numbers are unchanged."""
        if self._catalogue is None or isinstance(value, Markup) or not isinstance(value, str):
            return value
        return self._catalogue.say(value)

    def chart(self, data: Any) -> Any:
        """A chart's definition with translated titles."""
        return data if self._catalogue is None else self._catalogue.chart(data)

    def _filled(self, sentence: str, values: Mapping[str, Any]) -> Markup:
        said = {name: value if name in OF_PEOPLE else self.say(value) for name, value in values.items()}
        return Markup(sentence) % said  # noqa: S704 - sentences are of templates and the catalogue; values are escaped


READ_BY_PEOPLE = ("text/html", "application/problem+json")
"""Media types that depend on the language; all others are for programs, or their routes decide."""
PAPERS = ("application/pdf", "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet")
"""Media types of answers in the language of the requester, or stored in that of the approver."""


class LanguageHeaders:
    """Outermost middleware: errors of any part pass through it."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything through, with the headers of its language."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        await self.app(scope, receive, _LanguageSend(scope, send))


class _LanguageSend:
    def __init__(self, scope: Scope, send: Send) -> None:
        self._send, self._language = send, asked(scope)
        self._by_hand = chosen_by_query(scope["query_string"].decode("latin-1"))

    async def __call__(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            kind = MutableHeaders(scope=message).get("content-type", "")
            if kind.startswith((*READ_BY_PEOPLE, *PAPERS)):
                self._add_headers(MutableHeaders(scope=message), kind)
        await self._send(message)

    def _add_headers(self, headers: MutableHeaders, kind: str) -> None:
        if kind.startswith(READ_BY_PEOPLE):
            headers.setdefault("Content-Language", self._language.value)
        headers.add_vary_header("Accept-Language")
        headers.add_vary_header("Cookie")
        if self._by_hand and kind.startswith("text/html"):
            headers.append(
                "Set-Cookie", f"{COOKIE}={self._by_hand.value}; Path=/; Max-Age={YEAR}; SameSite=Lax; HttpOnly"
            )
