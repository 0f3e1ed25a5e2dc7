"""The API for dashboards and notebooks: forms of tables, times in milliseconds, answers that may be cached."""

import io
from collections.abc import Callable
from datetime import datetime

import httpx
import polars as pl
import pytest

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - a hook
from tests.service.made_sessions import FAILED, session_bytes

HISTORY, REPORT = "/api/v1/units/BA-017/history", "/api/v1/fleet/report"
READERS: dict[str, Callable[..., pl.DataFrame]] = {
    "text/csv": pl.read_csv,
    "application/vnd.apache.parquet": pl.read_parquet,
    "application/vnd.apache.arrow.stream": pl.read_ipc_stream,
}
DAY = 86_400_000
"""Milliseconds."""


@pytest.fixture
def measured(holding: Holding) -> httpx.Client:
    """A unit whose second session is out of tolerance."""
    return holding(*FAILED)


@pytest.mark.parametrize("media", READERS)
@pytest.mark.parametrize(("path", "rows"), [(HISTORY, "points"), (REPORT, "units")])
def test_every_form_that_a_header_asks_for_holds_the_same_rows(
    measured: httpx.Client, path: str, rows: str, media: str
) -> None:
    answer = measured.get(path, headers={"Accept": f"{media}, application/json;q=0.5"})
    assert answer.headers["content-type"].split(";")[0] == media
    assert "Accept" in answer.headers["vary"].split(", ")
    table = READERS[media](io.BytesIO(answer.content))
    listed = measured.get(path).json()[rows]
    shared = set(table.columns) & set(listed[0]) - {"at", "last_at", "due"}
    assert len(shared) > 10
    for name in shared:
        assert table[name].to_list() == [row[name] for row in listed]


def test_the_address_comes_before_the_header(measured: httpx.Client) -> None:
    answer = measured.get(HISTORY, params={"format": "arrow"}, headers={"Accept": "text/csv"})
    assert answer.headers["content-type"] == "application/vnd.apache.arrow.stream"


@pytest.mark.parametrize("accept", ["*/*", "text/html,*/*;q=0.8", "image/png", "", ";;q=,,", "text/csv;q=0.1, */*"])
def test_whoever_asks_for_no_table_gets_json(measured: httpx.Client, accept: str) -> None:
    assert measured.get(HISTORY, headers={"Accept": accept}).headers["content-type"] == "application/json"


def test_moments_come_in_iso_and_in_milliseconds(measured: httpx.Client) -> None:
    for point in measured.get(HISTORY).json()["points"]:
        assert datetime.fromisoformat(point["at"]).timestamp() * 1000 == point["at_ms"]
    (unit,) = measured.get(REPORT).json()["units"]
    assert datetime.fromisoformat(unit["last_at"]).timestamp() * 1000 == unit["last_at_ms"]


def test_a_history_is_cut_by_milliseconds_as_by_dates(measured: httpx.Client) -> None:
    at = measured.get(HISTORY).json()["points"][-1]["at_ms"]
    cut = measured.get(HISTORY, params={"since": at, "until": at + DAY}).json()["points"]
    assert {point["at_ms"] for point in cut} == {at}
    assert measured.get(HISTORY, params={"since": at - DAY, "until": at}).json()["points"] == []


def test_seconds_are_not_taken_for_milliseconds(client: httpx.Client) -> None:
    answer = client.get("/api/v1/sessions", params={"since": 1_772_000_000})
    assert "milliseconds since 1970" in answer.json()["problems"][0]["message"]


@pytest.mark.parametrize("path", [HISTORY, f"{HISTORY}?format=arrow", REPORT, "/api/v1/fleet", "/api/v1/units"])
def test_what_is_held_already_is_not_sent_again_until_it_changes(measured: httpx.Client, path: str) -> None:
    first = measured.get(path)
    again = measured.get(path, headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", first.headers["etag"])
    assert first.headers["cache-control"] == again.headers["cache-control"] == "private, no-cache"
    measured.post("/api/v1/sessions", content=session_bytes(seed=3, month=6))
    anew = measured.get(path, headers={"If-None-Match": first.headers["etag"]})
    assert (anew.status_code, anew.headers["etag"] == first.headers["etag"]) == (200, False)


def test_the_tag_of_a_compressed_answer_is_known_again(measured: httpx.Client) -> None:
    packed = measured.get(HISTORY, headers={"Accept-Encoding": "gzip"})
    assert packed.headers["content-encoding"] == "gzip"
    assert measured.get(HISTORY, headers={"If-None-Match": f'"other", {packed.headers["etag"]}'}).status_code == 304


def test_nothing_held_stands_in_the_way_of_a_refusal(measured: httpx.Client) -> None:
    answer = measured.get("/api/v1/units/none/history", headers={"If-None-Match": "*"})
    assert (answer.status_code, "etag" in answer.headers) == (404, False)
