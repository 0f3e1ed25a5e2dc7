"""Connections that are given up: whose request does not arrive, whose answer is not taken, and one too many.

uvicorn drops a connection that is idle between two requests, and no other. Here too the time of the client alone
counts.
"""

import asyncio
import json
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from service.boundary.pace import LATE, SLOWEST

FULL = "As many connections are open as this service takes. Try again in a few seconds."
NO_HTTP = "This is not a request of HTTP/1.1."
RETRY_AFTER = 5
"""Seconds: most answers take far less."""
TURNED_AWAY = 1.0
"""Seconds that a connection too many has to send its request, so that it can read why it is closed."""


class PatientProtocol(H11Protocol):
    """HTTP/1.1 on one connection, with an end to the waiting."""

    patience = 10.0
    """Seconds that the head of a request may take, and that an answer may make no way."""
    most_connections = 500
    """Open at once."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._head: asyncio.TimerHandle | None = None
        self._writing: asyncio.TimerHandle | None = None
        self._turned_away = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn's own
        super().connection_made(transport)
        if len(self.connections) > self.most_connections:
            self._turn_away()
        else:
            self._watch_head()

    def connection_lost(self, exc: Exception | None) -> None:
        self._stop_watching()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        if self._turned_away:
            self.transport.close()
            return
        super().data_received(data)
        self._watch_head()

    def on_response_complete(self) -> None:
        super().on_response_complete()
        if self.conn.their_state is h11.SEND_BODY:
            self._watch_head()

    def pause_writing(self) -> None:
        super().pause_writing()
        self._watch_writing()

    def resume_writing(self) -> None:
        super().resume_writing()
        if self._writing is not None:
            self._writing.cancel()
            self._writing = None

    def timeout_keep_alive_handler(self) -> None:
        super().timeout_keep_alive_handler()
        self.loop.call_later(self.patience, self.transport.abort)

    def send_400_response(self, msg: str) -> None:
        self.transport.write(_refusal(400, "Bad Request", NO_HTTP))
        self._give_up()

    def _watch_head(self) -> None:
        """Starts or stops the clock: it runs while a head, or the rest of a body that was answered, is to come."""
        rest = self.conn.their_state is h11.SEND_BODY and self.conn.our_state is h11.DONE
        if self.conn.their_state is not h11.IDLE and not rest:
            if self._head is not None:
                self._head.cancel()
                self._head = None
        elif self._head is None and not self.transport.is_closing():
            self._head = self._clock(self.patience)

    def _clock(self, seconds: float) -> asyncio.TimerHandle:
        return self.loop.call_later(seconds, self._head_missing, self.loop.time() + seconds)

    def _head_missing(self, end: float) -> None:
        """Gives the connection up, unless the service was late itself: then what came is looked at first."""
        if self.loop.time() - end < LATE:
            self._give_up()
        else:
            self._head = self._clock(LATE)

    def _watch_writing(self) -> None:
        left = self.transport.get_write_buffer_size()
        self._writing = self.loop.call_later(self.patience, self._written, left)

    def _written(self, before: int) -> None:
        """Gives up a client that took less of its answer than the slowest line carries."""
        if before - self.transport.get_write_buffer_size() < min(self.patience * SLOWEST, before):
            self.transport.abort()
        else:
            self._watch_writing()

    def _turn_away(self) -> None:
        """Says that there are too many; the connection is not counted while it reads that."""
        self._turned_away = True
        self.connections.discard(self)
        self.transport.write(_refusal(503, "Service Unavailable", FULL, f"Retry-After: {RETRY_AFTER}\r\n"))
        self.loop.call_later(TURNED_AWAY, self.transport.abort)

    def _give_up(self) -> None:
        """Closes the connection, at last also over an answer that nobody takes."""
        self._stop_watching()
        self.transport.close()
        self.loop.call_later(self.patience, self.transport.abort)

    def _stop_watching(self) -> None:
        for clock in (self._head, self._writing):
            if clock is not None:
                clock.cancel()
        self._head = self._writing = None


def _refusal(status: int, title: str, detail: str, headers: str = "") -> bytes:
    """A whole answer, in the one shape of every error."""
    body = json.dumps({"type": "about:blank", "title": title, "status": status, "detail": detail})
    return (
        f"HTTP/1.1 {status} {title}\r\nContent-Type: application/problem+json\r\nContent-Length: {len(body)}\r\n"
        f"{headers}Connection: close\r\n\r\n{body}"
    ).encode()
