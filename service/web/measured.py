"""Every request under an id, counted in the metrics and logged in one line."""

import re
from time import perf_counter
from uuid import uuid4

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bound_contextvars

from service.kit.log import REQUEST_ID, log
from service.kit.metrics import Metrics
from service.web.headers import API as PREFIX

PLAIN_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
"""An id of the client is accepted if it cannot be mistaken for anything else in a log."""
FAILED = 500
"""Status of an answer that was never sent: the server then sends its own."""


class RequestLog:
    """Identifies and times every request; outermost, so that it records the answer as sent."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self.app = app
        self.metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything through; an answer is recorded when its end is sent, before background tasks."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        id, start, status, is_recorded = _id(scope), perf_counter(), FAILED, False
        scope.setdefault("state", {})["request_id"] = id

        async def with_id(message: Message) -> None:
            nonlocal status, is_recorded
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)[REQUEST_ID] = id
            elif message["type"] == "http.response.body" and not message.get("more_body"):
                is_recorded = True
                self._record(scope, status, perf_counter() - start)
            await send(message)

        with bound_contextvars(request_id=id):
            try:
                await self.app(scope, receive, with_id)
            finally:
                if not is_recorded:
                    self._record(scope, status, perf_counter() - start)

    def _record(self, scope: Scope, status: int, seconds: float) -> None:
        method, operation = scope["method"], getattr(scope.get("route"), "name", None)
        self.metrics.count_request(method, operation, status, seconds)
        log.info("request", method=method, path=_template(scope), status=status, milliseconds=round(1000 * seconds, 1))


def _id(scope: Scope) -> str:
    """The client's id, if it is short and plain; else a new one."""
    client_id = Headers(scope=scope).get(REQUEST_ID, "")
    return client_id if PLAIN_ID.fullmatch(client_id) else uuid4().hex


def _template(scope: Scope) -> str | None:
    """Path template of the route; None where no route matched."""
    path = getattr(scope.get("route"), "path", None)
    return f"{PREFIX}{path}" if path is not None and scope["path"].startswith(f"{PREFIX}/") else path
