"""The log: one line a request, without anything that was sent in confidence."""

import io
import json
import logging
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from service.app import create_app
from service.kit.log import log, write_log
from service.settings import Settings
from tests.serving import http_client

ID = "X-Request-Id"


class Terminal(io.StringIO):
    """A stream that people read."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def failing(settings: Settings) -> Iterator[httpx.Client]:
    """HTTP to a service with a route that nobody foresaw to fail."""
    app: FastAPI = create_app(settings)

    @app.get("/failing/{name}")
    def fail(name: str) -> None:
        raise RuntimeError("foreseen by nobody")

    with http_client(app) as http:
        yield http


def lines(stream: io.StringIO) -> list[dict[str, Any]]:
    return [json.loads(line) for line in stream.getvalue().splitlines()]


def test_a_request_leaves_one_line(written: io.StringIO, client: httpx.Client) -> None:
    answer = client.get("/healthz")
    [line] = lines(written)
    assert (line["event"], line["level"]) == ("request", "info")
    assert (line["method"], line["path"], line["status"]) == ("GET", "/healthz", 200)
    assert line["request_id"] == answer.headers[ID]
    assert 0 < line["milliseconds"] < 60_000


@pytest.mark.parametrize(
    ("path", "template", "status"),
    [
        ("/api/v1/units/none", "/api/v1/units/{serial:path}", 404),
        ("/units/none", "/units/{serial:path}", 404),
        ("/api/v1/units?page=0", "/api/v1/units", 422),
        ("/api/v1/nothing", None, 404),
    ],
)
def test_an_error_leaves_a_line_too(
    written: io.StringIO, client: httpx.Client, path: str, template: str | None, status: int
) -> None:
    assert client.get(path).status_code == status
    [line] = lines(written)
    assert (line["path"], line["status"]) == (template, status)


def test_what_nobody_foresaw_is_told_with_its_place_and_its_request(
    written: io.StringIO, failing: httpx.Client
) -> None:
    answer = failing.get("/failing/once")
    assert answer.status_code == 500
    request, failure = lines(written)[:2]
    assert (request["path"], request["status"]) == ("/failing/{name}", 500)
    assert "test_log.py" in failure["exception"]
    assert request["request_id"] == failure["request_id"] == answer.headers[ID]


def test_a_page_in_place_of_the_failure_names_the_request_too(written: io.StringIO, failing: httpx.Client) -> None:
    answer = failing.get("/failing/once", headers={"Accept": "text/html"})
    assert answer.headers[ID] == lines(written)[0]["request_id"]


def test_an_id_is_handed_on(written: io.StringIO, client: httpx.Client) -> None:
    answer = client.get("/healthz", headers={ID: "trace-7.a_B"})
    assert answer.headers[ID] == lines(written)[0]["request_id"] == "trace-7.a_B"


@pytest.mark.parametrize("id", ["", "a b", "x" * 65, 'x"}', "x\u00e9"])
def test_an_id_that_is_long_or_not_plain_is_replaced(client: httpx.Client, id: str) -> None:
    found = client.get("/healthz", headers=[(ID.encode(), id.encode())]).headers[ID]
    assert len(found) == 32
    assert found.isalnum()


def test_neither_query_nor_body_nor_header_is_written(written: io.StringIO, client: httpx.Client) -> None:
    client.get("/api/v1/units?serial=SECRET", headers={"Authorization": "SECRET"})
    client.post("/api/v1/webhooks", json={"url": "https://example.org/", "secret": "SECRET" * 3, "by": "SECRET"})
    assert len(lines(written)) == 2
    assert "SECRET" not in written.getvalue()


def test_warnings_carry_the_fields_that_they_are_given(written: io.StringIO) -> None:
    log.warning("diagnosis pending", session="3f9a", reason="away")
    [line] = lines(written)
    assert (line["event"], line["level"], line["session"], line["reason"]) == (
        "diagnosis pending", "warning", "3f9a", "away",
    )  # fmt: skip


def test_libraries_write_into_the_same_log_but_only_warnings(written: io.StringIO) -> None:
    logging.getLogger("a.library").warning("something %s", "odd")
    logging.getLogger("a.library").info("usual")
    assert [line["event"] for line in lines(written)] == ["something odd"]


@pytest.mark.usefixtures("written")
def test_on_a_terminal_a_line_is_for_people() -> None:
    terminal = Terminal()
    write_log(terminal)
    log.info("request", status=200)
    assert "status" in terminal.getvalue()
    with pytest.raises(json.JSONDecodeError):
        json.loads(terminal.getvalue())
