"""Every answer that people read, in their language: what is refused is said in it, and caches are told."""

import json
from time import thread_time
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.languages.catalogue import catalogue_of
from service.languages.language import COOKIE, YEAR, Language, asked, chosen_by_query

READ_BY_PEOPLE = ("text/html", "application/problem+json")
"""Kinds of answers that depend on the language; all others are for programs, or their routes say it."""
PROBLEM = "application/problem+json"
PAPERS = ("application/pdf", "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet")
"""Made in the language of the one who asks, or kept in that of the one who approved them."""
SAID = ("title", "detail")
PATIENCE = 2.0
"""Seconds of computing for which a refusal's sentences are looked up; a file may be made so that they are many and
take long, and the rest is then in English."""


class InOneLanguage:
    """Outside of everything that answers: errors of any part pass it."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything through; problems on their way to a program that asks for Russian are said in it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        await self.app(scope, receive, _Speaker(scope, send))


class _Speaker:
    """Adds the headers of a language; holds back a problem that is to be translated until it is complete."""

    def __init__(self, scope: Scope, send: Send) -> None:
        self._send, self._language = send, asked(scope)
        self._by_hand = chosen_by_query(scope["query_string"].decode("latin-1"))
        self._held: Message | None = None
        self._body = b""

    async def __call__(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            kind = MutableHeaders(scope=message).get("content-type", "")
            if kind.startswith((*READ_BY_PEOPLE, *PAPERS)):
                self._tell(MutableHeaders(scope=message), kind)
            if kind.startswith(PROBLEM) and self._language is not Language.ENGLISH:
                self._held = message
                return
        if self._held is None:
            await self._send(message)
            return
        self._body += message.get("body", b"")
        if not message.get("more_body", False):
            await self._send_said(self._held)

    def _tell(self, headers: MutableHeaders, kind: str) -> None:
        if kind.startswith(READ_BY_PEOPLE):
            headers.setdefault("Content-Language", self._language.value)
        headers.add_vary_header("Accept-Language")
        headers.add_vary_header("Cookie")
        if self._by_hand and kind.startswith("text/html"):
            headers.append(
                "Set-Cookie", f"{COOKIE}={self._by_hand.value}; Path=/; Max-Age={YEAR}; SameSite=Lax; HttpOnly"
            )

    async def _send_said(self, start: Message) -> None:
        if not self._body:  # of a HEAD request
            await self._send(start)
            await self._send({"type": "http.response.body", "body": b""})
            return
        told = await run_in_threadpool(in_words_of, self._language, json.loads(self._body))
        body = json.dumps(told, ensure_ascii=False).encode()
        MutableHeaders(scope=start)["Content-Length"] = str(len(body))
        await self._send(start)
        await self._send({"type": "http.response.body", "body": body})


def in_words_of(language: Language, problem: dict[str, Any]) -> dict[str, Any]:
    """A problem with its sentences said in a language; its keys and fields stay."""
    catalogue = catalogue_of(language)
    end = thread_time() + PATIENCE

    def say(text: str) -> str:
        return catalogue.say(text) if thread_time() < end else text

    told = problem | {key: say(problem[key]) for key in SAID if key in problem}
    if "problems" in told:
        told["problems"] = [one | {"message": say(one["message"])} for one in told["problems"]]
    return told
