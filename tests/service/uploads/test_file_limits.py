"""Limits on the content of a file and on the number taken at once, each with its answer."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace

import httpx
import pytest

from benchmarks.files.hostile import HOSTILE
from service.app import create_app
from service.kit.limits import SMALL, limits_of
from service.settings import Settings
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.serving import http_client, limited_client

LARGE = 2 * 1024 * 1024
Limited = Callable[..., httpx.Client]


@pytest.fixture
def limited(settings: Settings) -> Iterator[Limited]:
    """A service with other limits."""
    with ExitStack() as stack:
        yield lambda **changes: stack.enter_context(limited_client(settings, **changes))


@one_engine
@pytest.mark.parametrize(
    ("name", "most", "words"),
    [
        ("rows", 3, "rows; at most 3"),
        ("columns", 4, "columns; at most 4"),
        ("cells", 20, "at most 20 cells"),
        ("nesting", 2, "nested deeper than 2"),
    ],
)
def test_a_file_beyond_a_limit_is_refused_with_what_to_do(limited: Limited, name: str, most: int, words: str) -> None:
    answer = limited(**{name: most}).post("/api/v1/sessions", content=session_bytes())
    assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json")
    assert words in answer.json()["problems"][0]["message"]


@one_engine
def test_a_file_that_ended_processes_ends_none(limited: Limited) -> None:
    client = limited()
    (hostile,) = (one for one in HOSTILE if one.name == "xlsx-sheet-called-a-picture")
    answer = client.post("/api/v1/sessions", files={"file": hostile.make()})
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "file")
    assert client.post("/api/v1/sessions", content=session_bytes()).status_code == 201


@one_engine
@pytest.mark.parametrize("path", ["/api/v1/sessions", "/upload"])
def test_beyond_the_large_uploads_in_flight_a_sender_is_asked_to_come_again(settings: Settings, path: str) -> None:
    app = create_app(settings, most=replace(SMALL, in_flight=1))
    with http_client(app) as client:
        with app.state.application.places.one_for("", 1):
            second = client.post(path, files={"files": b" " * LARGE})
            small = client.post("/api/v1/sessions", content=session_bytes())
        third = client.post("/api/v1/sessions", content=b" " * LARGE)
    assert (second.status_code, second.headers["retry-after"]) == (503, "5")
    assert (small.status_code, third.status_code) == (201, 422)


def test_a_large_machine_takes_files_of_four_times_the_size_and_as_deeply_nested() -> None:
    small, large = (limits_of(Settings(machine=size)) for size in ("small", "large"))
    assert (large.cells, large.memory, large.whole) == (4 * small.cells, 4 * small.memory, 4 * small.whole)
    assert (large.nesting, large.columns, large.body) == (small.nesting, small.columns, small.body)
