"""Every request under an id, counted in the figures and told in the log by one line."""

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
"""An id that came with a request is handed on if nothing in it can be taken for anything else in a log."""
FAILED = 500
"""The status of an answer that never came: what is then sent comes from outside of here."""


class Measured:
    """Names and times every request; stands outside of all that answers, so that what it notes is what was sent."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self.app = app
        self.metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything through; an answer is noted when its end is sent, before what may run after it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        id, start, status, noted = _id(scope), perf_counter(), FAILED, False
        scope.setdefault("state", {})["request_id"] = id

        async def named(message: Message) -> None:
            nonlocal status, noted
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)[REQUEST_ID] = id
            elif message["type"] == "http.response.body" and not message.get("more_body"):
                noted = True
                self._note(scope, status, perf_counter() - start)
            await send(message)

        with bound_contextvars(request_id=id):
            try:
                await self.app(scope, receive, named)
            finally:
                if not noted:
                    self._note(scope, status, perf_counter() - start)

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        method, operation = scope["method"], getattr(scope.get("route"), "name", None)
        self.metrics.count_request(method, operation, status, seconds)
        log.info("request", method=method, path=_template(scope), status=status, milliseconds=round(1000 * seconds, 1))


def _id(scope: Scope) -> str:
    """The id that the request brought, if it is short and plain; else a new one."""
    brought = Headers(scope=scope).get(REQUEST_ID, "")
    return brought if PLAIN_ID.fullmatch(brought) else uuid4().hex


def _template(scope: Scope) -> str | None:
    """The path of the route, with blanks for what stands in them; None where no route took the request."""
    path = getattr(scope.get("route"), "path", None)
    return f"{PREFIX}{path}" if path is not None and scope["path"].startswith(f"{PREFIX}/") else path
