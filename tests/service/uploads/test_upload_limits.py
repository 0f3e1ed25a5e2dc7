"""An upload beyond the limit is stopped, whatever it announces."""

from collections.abc import Iterator

import httpx
import pytest

from service.settings import Settings
from tests.databases import one_engine
from tests.serving import limited_client

LIMIT = 100_000


@pytest.fixture
def small(settings: Settings) -> Iterator[httpx.Client]:
    """A service that takes small files only."""
    with limited_client(settings, whole=LIMIT) as client:
        yield client


def pieces() -> Iterator[bytes]:
    """Bytes that come without an announced length."""
    for _ in range(30):
        yield b" " * 10_000


@one_engine
def test_a_long_body_is_refused(small: httpx.Client) -> None:
    answer = small.post("/api/v1/sessions", content=b" " * (LIMIT + 1))
    assert (answer.status_code, answer.headers["content-type"]) == (413, "application/problem+json")
    assert "100,000 bytes" in answer.json()["detail"]


@one_engine
def test_a_body_of_unknown_length_is_stopped(small: httpx.Client) -> None:
    assert small.post("/api/v1/sessions", content=pieces()).status_code == 413


@one_engine
def test_a_long_file_in_a_form_is_refused(small: httpx.Client) -> None:
    assert small.post("/api/v1/sessions", files={"file": b" " * (LIMIT + 100_000)}).status_code == 413


@one_engine
def test_a_file_at_the_limit_is_read(small: httpx.Client) -> None:
    assert small.post("/api/v1/sessions", content=b" " * LIMIT).status_code == 422
