"""No body grows without bound, whatever it announces and however it comes."""

import json
import resource
from collections.abc import Iterator

import httpx
import pytest

from tests.service.made_sessions import session_bytes
from tests.service.web.conftest import At
from tests.service.web.raw import Answer, head, sent

MEGABYTE = b"x" * 2**20
ROUTES = (
    ("POST", "/api/v1/units/BA-017/notes"),
    ("PUT", "/api/v1/units/BA-017/lot"),
    ("POST", "/flags/1/resolve"),
    ("GET", "/api/v1/units"),
    ("POST", "/nothing"),
)


def chunks(count: int) -> Iterator[bytes]:
    """Megabytes one after another, without a length in front."""
    for _ in range(count):
        yield MEGABYTE


@pytest.mark.parametrize(("method", "path"), ROUTES)
def test_what_announces_too_much_is_refused_before_it_is_sent(at: At, method: str, path: str) -> None:
    found = sent(at(), head(method, path, Content_Length="200000000"))
    assert found.status == 413
    assert "262,144 bytes" in json.loads(found.body)["detail"]


@pytest.mark.parametrize(
    ("path", "kind"),
    [
        ("/api/v1/units/BA-017/notes", "application/json"),
        ("/api/v1/units/BA-017/notes", "text/plain"),
        ("/flags/1/resolve", "application/x-www-form-urlencoded"),
    ],
)
def test_what_turns_out_too_large_is_refused_while_it_comes(at: At, path: str, kind: str) -> None:
    answer = httpx.post(at() + path, content=chunks(3), headers={"Content-Type": kind})
    assert (answer.status_code, answer.headers["content-type"]) == (413, "application/problem+json")


def test_a_note_of_200_mb_is_never_held(at: At) -> None:
    address = at()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    answer = httpx.post(f"{address}/api/v1/units/BA-017/notes", content=chunks(200))
    assert answer.status_code == 413
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 20 * 1024  # kilobytes


@pytest.mark.parametrize("length", ["-1", "1e3", "0x10", "9" * 40, "1, 2", "abc"])
def test_a_length_that_is_none_is_no_request(at: At, length: str) -> None:
    assert sent(at(), head("POST", "/api/v1/sessions", Content_Length=length)).status in (400, 413)


def test_a_length_and_chunks_together_are_read_as_chunks_and_counted(at: At) -> None:
    chunk = b"40000\r\n" + b"x" * 2**18 + b"\r\n"
    both = {"Content_Length": "3", "Transfer_Encoding": "chunked", "Content_Type": "application/json"}
    found = sent(at(), head("POST", "/api/v1/units/B/notes", **both) + chunk * 2)
    assert found.status in (400, 413)


def test_uploads_keep_their_own_limit(at: At) -> None:
    large = session_bytes() + b" " * 2**19
    assert httpx.post(f"{at()}/api/v1/sessions", content=large).status_code == 201


def test_the_connection_goes_on_after_a_body_that_was_too_large(at: At) -> None:
    with httpx.Client(base_url=at()) as client:
        assert client.post("/api/v1/units/B/notes", content=MEGABYTE).status_code == 413
        assert client.get("/healthz").status_code == 200


def test_a_large_body_is_refused_with_a_page_in_a_browser(at: At) -> None:
    found: Answer = sent(at(), head("POST", "/flags/1/resolve", Content_Length="200000000", Accept="text/html"))
    assert (found.status, b'<section id="problem"' in found.body) == (413, True)
