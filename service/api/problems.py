"""Every error of the service as application/problem+json."""

from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException

from estimator.errors import Problem
from service.errors import AwayError, RefusedError, ServiceError, SignInError, TooOftenError
from service.log import log

MEDIA_TYPE = "application/problem+json"
"""RFC 9457."""
UNEXPECTED = "Something went wrong that should not have. It was logged; nothing was stored half."
"""Says nothing of the cause, which may hold what others must not read; the log has it."""
BODY_PARTS = ("body", "query", "path", "header")
"""What FastAPI puts before the name of a field."""


def add_problem_handlers(app: FastAPI) -> None:
    """Gives every error of the application the one shape."""
    app.add_exception_handler(ServiceError, _service_error)
    app.add_exception_handler(RequestValidationError, _invalid_request)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(Exception, _unexpected)


def problem(
    status: int, detail: str, problems: Sequence[Problem] | None = None, headers: Mapping[str, str] | None = None
) -> JSONResponse:
    """The answer to a request that was not carried out."""
    content: dict[str, Any] = {
        "type": "about:blank",
        "title": HTTPStatus(status).phrase,
        "status": status,
        "detail": detail,
    }
    if problems is not None:
        content["problems"] = [{"field": p.field, "row": p.row, "message": p.message} for p in problems]
    return JSONResponse(content, status, headers, MEDIA_TYPE)


def _service_error(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, ServiceError)
    headers = {"Retry-After": str(error.retry_after)} if isinstance(error, AwayError | TooOftenError) else None
    if isinstance(error, SignInError):
        headers = {"WWW-Authenticate": "Bearer"}
    found = error.problems if isinstance(error, RefusedError) else None
    return problem(error.status, error.detail, found, headers)


def _invalid_request(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    found = [Problem(_place(fault["loc"]), fault["msg"]) for fault in error.errors()]
    return problem(422, "The request cannot be used.", found)


def _place(location: Sequence[int | str]) -> str:
    """``body.kind`` of FastAPI is ``kind`` to the one who asked."""
    parts = location[1:] if location and location[0] in BODY_PARTS and len(location) > 1 else location
    return ".".join(map(str, parts))


def _http_error(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    details = {
        404: f"There is nothing at {request.url.path}.",
        405: f"{request.method} is not possible at {request.url.path}.",
    }
    return problem(error.status_code, details.get(error.status_code, error.detail), None, error.headers)


def _unexpected(request: Request, error: Exception) -> JSONResponse:
    """The one boundary for what nobody foresaw."""
    log.error("request failed", request_id=request.state.request_id, exc_info=error)
    return problem(500, UNEXPECTED)
