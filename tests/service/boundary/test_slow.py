"""Clients that send or read too slowly are given up; those that are merely slow are not."""

import io
import json
import select
import socket
from contextlib import ExitStack, suppress
from time import monotonic

import httpx

from tests.patience import LONG
from tests.service.boundary.conftest import At
from tests.service.boundary.raw import answer, connected, head, received
from tests.service.sessions import session_bytes

FORM = "application/x-www-form-urlencoded"
SHORT = 0.4
"""Seconds of patience, so that a test is quick."""


def closed_after(connection: socket.socket) -> float:
    """Seconds until the other side closes."""
    start = monotonic()
    received(connection)
    return monotonic() - start


def is_given_up(connection: socket.socket) -> bool:
    """Whether a connection is closed although a byte is sent whenever nothing came for a moment."""
    start = monotonic()
    while monotonic() - start < LONG:
        try:
            connection.sendall(b"X")
            if connection.recv(1) == b"":
                return True
        except TimeoutError:
            continue
        except ConnectionError:
            return True
    return False


def test_a_head_that_never_ends_is_not_waited_for(at: At) -> None:
    address = at(client_seconds=SHORT)
    with ExitStack() as opened:
        slow = [opened.enter_context(connected(address, LONG)) for _ in range(20)]
        for number, connection in enumerate(slow):
            connection.sendall(head("GET", "/")[: number or None] if number < 19 else b"")
        assert all(closed_after(connection) < LONG for connection in slow)
        assert httpx.get(f"{address}/healthz").status_code == 200


def test_a_byte_now_and_then_does_not_keep_a_head_alive(at: At) -> None:
    with connected(at(client_seconds=SHORT), SHORT / 4) as connection:
        assert is_given_up(connection)


def test_a_body_that_does_not_come_is_said_and_not_waited_for(at: At) -> None:
    address = at(client_seconds=SHORT)
    for path in ("/api/v1/sessions", "/api/v1/units/B/notes", "/upload", "/flags/1/resolve"):
        form, start = ("multipart/form-data; boundary=x", b"--x") if path == "/upload" else (FORM, b"by=")
        with connected(address, LONG) as connection:
            connection.sendall(head("POST", path, Content_Length="1000", Content_Type=form) + start)
            found = answer(connection)
        assert (found.status, json.loads(found.body)["status"]) == (408, 408), path
        assert "connection: close" in found.head


def test_the_rest_of_a_body_that_was_answered_is_not_waited_for(at: At) -> None:
    with connected(at(client_seconds=SHORT)) as connection:
        connection.sendall(head("POST", "/nothing", Connection="keep-alive", Content_Length="100000"))
        assert connection.recv(65536).startswith(b"HTTP/1.1 404")
        connection.settimeout(SHORT / 4)
        assert is_given_up(connection)


def test_an_upload_that_is_cut_off_is_no_fault_of_the_service(at: At, written: io.StringIO) -> None:
    address = at()
    for path in ("/api/v1/sessions", "/upload"):
        kind = "multipart/form-data; boundary=x" if path == "/upload" else "application/json"
        with connected(address) as connection:
            connection.sendall(head("POST", path, Content_Length="1000", Content_Type=kind) + b"--x")
        while path not in written.getvalue():
            httpx.get(f"{address}/healthz")
    assert '"level": "error"' not in written.getvalue()


def test_a_slow_but_steady_body_is_taken(at: At) -> None:
    content = session_bytes()
    with connected(at(client_seconds=30.0)) as connection:
        connection.sendall(head("POST", "/api/v1/sessions", Content_Length=str(len(content))))
        for start in range(0, len(content), 1000):
            connection.sendall(content[start : start + 1000])
        assert answer(connection).status == 201


def test_an_answer_that_nobody_takes_is_given_up(at: At) -> None:
    with connected(at(client_seconds=SHORT), LONG) as connection:
        with suppress(ConnectionError):
            connection.sendall(head("GET", "/openapi.json", Connection="keep-alive") * 8000)
        watch = select.poll()
        watch.register(connection, 0)  # only that it was reset: requests that the service has not read make it so
        assert watch.poll(1000 * LONG)


def test_more_connections_than_allowed_are_told_so(at: At) -> None:
    address = at(max_connections=3)
    with ExitStack() as opened:
        for _ in range(3):
            opened.enter_context(connected(address))
        with connected(address, LONG) as one_too_many:
            one_too_many.sendall(head("GET", "/healthz"))
            found = answer(one_too_many)
    assert (found.status, json.loads(found.body)["status"]) == (503, 503)
    assert "retry-after: 5" in found.head
    assert httpx.get(f"{address}/healthz").status_code == 200


def test_what_is_no_http_gets_the_one_shape(at: At) -> None:
    with connected(at()) as connection:
        connection.sendall(b"\x16\x03\x01\x02\x00 hello\r\n\r\n")
        found = answer(connection)
    assert (found.status, json.loads(found.body)["status"]) == (400, 400)
