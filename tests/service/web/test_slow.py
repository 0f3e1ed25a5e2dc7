"""Bodies that come too slowly are rejected, those that are merely slow are not; connections are bounded."""

import io
import json
from contextlib import ExitStack

import httpx

from tests.patience import LONG
from tests.service.made_sessions import session_bytes
from tests.service.web.conftest import At
from tests.service.web.raw import answer, connected, head

FORM = "application/x-www-form-urlencoded"
SHORT = 0.4
"""Seconds of patience, so that a test is quick."""


def test_a_body_that_does_not_come_is_said_and_not_waited_for(at: At) -> None:
    address = at({"client": SHORT})
    for path in ("/api/v1/sessions", "/api/v1/units/B/notes", "/upload", "/flags/1/resolve"):
        form, start = ("multipart/form-data; boundary=x", b"--x") if path == "/upload" else (FORM, b"by=")
        with connected(address, LONG) as connection:
            connection.sendall(head("POST", path, Content_Length="1000", Content_Type=form) + start)
            found = answer(connection)
        assert (found.status, json.loads(found.body)["status"]) == (408, 408), path
        assert "connection: close" in found.head


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
    with connected(at({"client": 30.0})) as connection:
        connection.sendall(head("POST", "/api/v1/sessions", Content_Length=str(len(content))))
        for start in range(0, len(content), 1000):
            connection.sendall(content[start : start + 1000])
        assert answer(connection).status == 201


def test_more_connections_than_allowed_are_rejected(at: At) -> None:
    address = at({"connections": 3})
    with ExitStack() as opened:
        for _ in range(3):
            opened.enter_context(connected(address))
        with connected(address, LONG) as one_too_many:
            one_too_many.sendall(head("GET", "/healthz"))
            found = answer(one_too_many)
    assert found.status == 503
    assert httpx.get(f"{address}/healthz").status_code == 200
