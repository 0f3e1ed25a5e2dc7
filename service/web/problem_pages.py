"""Error pages: the service's one problem shape, shown to browsers."""

import json
from dataclasses import dataclass
from urllib.parse import quote

from fastapi import FastAPI, Request, Response
from fastapi.responses import RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from estimator.errors import Problem
from estimator.json_object import Json
from service.kit.log import REQUEST_ID
from service.web.headers import HEADERS
from service.web.render import render

PROBLEM = b"application/problem+json"
UNAUTHORIZED, SEE_OTHER = 401, 303
ADVICE = {
    401: "Sign in, then go back and send it once more.",
    403: (
        "If it was a form, open its page again and send it once more. If your role does not permit it, ask someone "
        "whose role does."
    ),
    404: "The address may be mistyped, or the link is older than the data.",
    408: "The connection may be slow or was interrupted: send it again.",
    409: "Look at the record again: it may have changed since the page was loaded.",
    413: "Shorten it; split a recording, or average it before the upload.",
    421: "Open the service by the address that its operator gives.",
    422: "Correct what is listed and try again.",
    503: "Nothing was lost. Try again in a few seconds.",
    507: "Nothing was lost. Ask the operator of this service to free disk space.",
}
DEFAULT_ADVICE = "Nothing was lost. Try again; if it happens again, tell the operator of this service."


@dataclass(frozen=True)
class ProblemPage:
    """Contents of an error page."""

    status: int
    title: str
    detail: str
    problems: tuple[Problem, ...]
    advice: str
    request_id: str
    """Id of the request in the log; empty where it has none."""


def problem_page(problem: Json) -> ProblemPage:
    """The page of a problem+json document."""
    status = int(problem["status"])
    return ProblemPage(
        status=status,
        title=str(problem.get("title", "Error")),
        detail=str(problem.get("detail", "")),
        problems=tuple(
            Problem(str(p.get("field", "")), str(p.get("message", "")), p.get("row"))
            for p in problem.get("problems", ())
        ),
        advice=ADVICE.get(status, DEFAULT_ADVICE),
        request_id=str(problem.get("request_id", "")),
    )


def unexpected_pages(app: FastAPI) -> None:
    """Answers unexpected errors with a page too: that handler is outside of every middleware.

    The server closes the connection after it, and the answer states that, lest the next request is sent into it.
    """
    answer = app.exception_handlers[Exception]

    def unexpected(request: Request, error: Exception) -> Response:
        response = answer(request, error)
        assert isinstance(response, Response)
        if _wants_page(request.scope):
            page = problem_page(json.loads(bytes(response.body)))
            response = render(request, "problem.html", page, page.status)
        response.headers.update({**HEADERS, REQUEST_ID: request.state.request_id, "Connection": "close"})
        return response

    app.add_exception_handler(Exception, unexpected)


class ProblemPages:
    """Turns problems for browsers into error pages; programs get them unchanged."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything through but problems for a browser."""
        if scope["type"] != "http" or not _wants_page(scope):
            await self.app(scope, receive, send)
            return
        await self.app(scope, receive, _PageSend(scope, receive, send))


def _wants_page(scope: Scope) -> bool:
    """Whether a browser asks for a page, perhaps by a link into the API; programs do not ask for HTML."""
    accepted = dict(scope["headers"]).get(b"accept", b"")
    return b"text/html" in accepted


class _PageSend:
    """Holds back a problem until it is complete, then sends the page in its place."""

    def __init__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.scope, self.receive, self.send = scope, receive, send
        self.start: Message | None = None
        self.body = b""

    async def __call__(self, message: Message) -> None:
        if message["type"] == "http.response.start" and _is_problem(message):
            self.start = message
        elif self.start is None:
            await self.send(message)
        else:
            self.body += message.get("body", b"")
            if not message.get("more_body", False):
                await self._send_page(self.start)

    async def _send_page(self, start: Message) -> None:
        page = problem_page(json.loads(self.body))
        if page.status == UNAUTHORIZED and self.scope["method"] == "GET":
            path = quote(Request(self.scope).url.path)
            await RedirectResponse(f"/sign-in?next={path}", SEE_OTHER)(self.scope, self.receive, self.send)
            return
        response = render(Request(self.scope), "problem.html", page, page.status)
        headers = [(k, v) for k, v in start["headers"] if k.lower() in (b"retry-after", b"allow")]
        response.raw_headers.extend(headers)
        await response(self.scope, self.receive, self.send)


def _is_problem(start: Message) -> bool:
    return any(k.lower() == b"content-type" and v.startswith(PROBLEM) for k, v in start["headers"])
