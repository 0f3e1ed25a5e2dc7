"""Every error of the service as application/problem+json."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.routing import Match
from starlette.types import Receive, Scope, Send

from estimator.errors import Problem
from estimator.json_object import Json
from estimator.message import say
from service.errors import AwayError, RefusedError, ServiceError, SignInError, TooOftenError
from service.kit.log import log, request_id
from service.languages.catalogue import catalogue_of
from service.languages.language import Language, asked
from service.web.faults import fault_in_words

MEDIA_TYPE = "application/problem+json"
"""RFC 9457."""
UNEXPECTED = "Unexpected error. It was logged; nothing was stored in part."
"""Does not state the cause, which may be confidential; the log has it."""
CUT_OFF = "The request ended before it was complete. Nothing was stored."
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")
BODY_PARTS = ("body", "query", "path", "header")
"""FastAPI's prefixes of a field's name."""


def add_problem_handlers(app: FastAPI) -> None:
    """Gives every error of the application the one shape."""
    app.add_exception_handler(ServiceError, _service_error)
    app.add_exception_handler(RequestValidationError, _invalid_request)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(ClientDisconnect, _cut_off)
    app.add_exception_handler(Exception, _unexpected)


class ProblemAnswer(JSONResponse):
    """A problem, with its sentences in the language of the requester."""

    media_type = MEDIA_TYPE

    def __init__(self, content: Mapping[str, Any], status: int, headers: Mapping[str, str] | None) -> None:
        super().__init__(content, status, headers)
        self._content = content

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Translates it when the requester is known."""
        language = asked(scope)
        if language is not Language.ENGLISH:
            self.body = self.render(_translated(self._content, catalogue_of(language).say))
            self.headers["Content-Length"] = str(len(self.body))
        await super().__call__(scope, receive, send)


def _translated(content: Mapping[str, Any], say: Callable[[str], str]) -> Json:
    translated = {**content, **{key: say(content[key]) for key in ("title", "detail")}}
    if "problems" in translated:
        translated["problems"] = [fault | {"message": say(fault["message"])} for fault in translated["problems"]]
    return translated


def problem(
    status: int,
    detail: str,
    problems: Sequence[Problem] | None = None,
    headers: Mapping[str, str] | None = None,
    id: str | None = None,
) -> ProblemAnswer:
    """The answer to a request that was not carried out; ``id`` where the context does not have it."""
    content: Json = {"type": "about:blank", "title": HTTPStatus(status).phrase, "status": status, "detail": detail}
    known_id = id or request_id()
    if known_id is not None:
        content["request_id"] = known_id
    if problems is not None:
        content["problems"] = [{"field": p.field, "row": p.row, "message": p.message} for p in problems]
    return ProblemAnswer(content, status, headers)


def _service_error(_: Request, error: Exception) -> ProblemAnswer:
    assert isinstance(error, ServiceError)
    headers = {"Retry-After": str(error.retry_after)} if isinstance(error, AwayError | TooOftenError) else None
    if isinstance(error, SignInError):
        headers = {"WWW-Authenticate": "Bearer"}
    problems = error.problems if isinstance(error, RefusedError) else None
    return problem(error.status, error.detail, problems, headers)


def _invalid_request(_: Request, error: Exception) -> ProblemAnswer:
    assert isinstance(error, RequestValidationError)
    problems = [Problem(_place(fault["loc"]), fault_in_words(fault)) for fault in error.errors()]
    return problem(422, "The request cannot be used.", problems)


def _place(location: Sequence[int | str]) -> str:
    """``body.kind`` of FastAPI is ``kind`` to the requester."""
    parts = location[1:] if location and location[0] in BODY_PARTS and len(location) > 1 else location
    return ".".join(map(str, parts))


def _http_error(request: Request, error: Exception) -> ProblemAnswer:
    assert isinstance(error, HTTPException)
    details = {
        404: say("There is nothing at {path}.", path=request.url.path),
        405: say("{method} is not possible at {path}.", method=request.method, path=request.url.path),
    }
    headers = {"Allow": _allowed(request)} if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED else error.headers
    return problem(error.status_code, details.get(error.status_code, error.detail), None, headers)


def _cut_off(_: Request, error: Exception) -> ProblemAnswer:
    """The answer to a request that was cut off: nobody reads it; it is one line in the log and no fault of the
    service.
    """
    return problem(400, CUT_OFF)


def _allowed(request: Request) -> str:
    """Every method that is accepted at this address; the framework names those of one route.

    Methods of a more general route are left out: /units/X/lot can be read as the page of a unit named "X/lot".
    """
    template = getattr(request.scope.get("route"), "path", None)
    every = _every(request.app.router.routes)
    accepted = {m for route in every if route.path in (template, request.scope["path"]) for m in route.methods}
    pairs = ((m, "GET" if m == "HEAD" else m) for m in METHODS)  # HEAD is answered wherever GET is
    return ", ".join(m for m, method in pairs if method in accepted and _is_taken(request, method))


def _is_taken(request: Request, method: str) -> bool:
    scope = {**request.scope, "method": method}
    return any(route.matches(scope)[0] is Match.FULL for route in request.app.router.routes)


def _every(routes: Iterable[Any]) -> Iterator[Any]:
    """The routes themselves, out of nested routers."""
    for route in routes:
        router = getattr(route, "original_router", None)
        yield from (route,) if router is None else _every(router.routes)


def _unexpected(request: Request, error: Exception) -> ProblemAnswer:
    """Answers an unexpected error; the one boundary for them."""
    log.error("request failed", request_id=request.state.request_id, exc_info=error)
    return problem(500, UNEXPECTED, id=request.state.request_id)
