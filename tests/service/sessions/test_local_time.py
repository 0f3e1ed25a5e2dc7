"""A session is dated as its file states it: the day and the offset of the place, ordered by UTC."""

import json

import httpx
import pytest

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes, session_id

AUCKLAND = "2026-03-02T08:30:00+13:00"
IN_AUCKLAND = session_bytes(started_at=AUCKLAND)
ID = session_id(IN_AUCKLAND)


@pytest.fixture
def client(holding: Holding) -> httpx.Client:
    return holding(IN_AUCKLAND)


def test_programs_read_the_moment_with_its_offset(client: httpx.Client) -> None:
    assert client.get(f"/api/v1/sessions/{ID}").json()["started_at"] == AUCKLAND
    assert client.get("/api/v1/units").json()["units"][0]["last_at"] == AUCKLAND


def test_pages_and_papers_show_the_day_of_the_place(client: httpx.Client) -> None:
    assert "2 Mar 2026" in client.get(f"/sessions/{ID}").text
    assert "2 Mar 2026" in client.get("/units/BA-017").text
    why = client.get("/api/v1/units/BA-017/usable").json()
    assert "2 Mar 2026" in json.dumps(why)
    dcc = client.get(f"/api/v1/sessions/{ID}/certificate?format=dcc").text
    assert "<dcc:beginPerformanceDate>2026-03-02</dcc:beginPerformanceDate>" in dcc


def test_sessions_are_in_order_of_time_whatever_their_offsets(holding: Holding) -> None:
    later = session_bytes(seed=2, started_at="2026-03-01T20:00:00Z")
    client = holding(later, IN_AUCKLAND)
    listed = client.get("/api/v1/sessions").json()["sessions"]
    assert [session["id"] for session in listed] == [session_id(later), ID]
