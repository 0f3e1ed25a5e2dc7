"""Moments with an offset from UTC: a session has the day of its place, on every page and paper; programs that compare
moments get UTC."""

import json
import re
from datetime import UTC, datetime, timedelta

import httpx
import pytest

from estimator import read_session
from estimator.errors import SessionError
from estimator.moments import local_moment, moment, written
from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.grouped import CUBIC, cubic_session
from tests.service.made_sessions import session_bytes
from tests.service.papers.documents import text_of

UNIT = "BA-017"
HTML = {"Accept": "text/html"}
EARLY = "2026-03-01T01:30:00+03:00"
"""Start of a session that in UTC is on the day before."""
MOMENT, DAY = datetime(2026, 2, 28, 22, 30, tzinfo=UTC), "1 Mar 2026"
OTHER_DAY = re.compile(r"2026-02-28|20260228|\b28 Feb 2026")


def session(number: int, cubic: float, started_at: str) -> bytes:
    return json.dumps(json.loads(cubic_session(number, cubic=cubic)) | {"started_at": started_at}).encode()


@pytest.fixture
def client(holding: Holding) -> httpx.Client:
    """Four sessions; the third, with an effect that the first two lack, was measured at night."""
    dates = "2026-01-10T09:00:00Z", "2026-02-10T09:00:00Z", EARLY, "2026-03-20T09:00:00-05:30"
    return holding(*(session(n, 8 * CUBIC * (n > 1), at) for n, at in enumerate(dates)))


@one_engine
def test_the_day_of_a_session_is_the_same_everywhere(client: httpx.Client) -> None:
    group = client.get(f"/api/v1/units/{UNIT}/diagnosis").raise_for_status().json()
    (finding,) = group["findings"]
    assert (finding["form"], finding["since"]) == ("since", "2026-02-28T22:30:00Z")
    (own,) = client.get("/api/v1/sessions", params={"unit": UNIT, "until": "2026-03-02", "since": MOMENT}).json()[
        "sessions"
    ]
    assert datetime.fromisoformat(own["started_at"]) == MOMENT
    api = f"/api/v1/sessions/{own['id']}"
    shown = {
        path: client.get(path, headers=HTML).raise_for_status().text
        for path in (f"/units/{UNIT}", f"/sessions/{own['id']}", f"/sessions/{own['id']}/certificate")
    }
    assert {path for path, page in shown.items() if DAY not in page} == set()
    del shown[f"/units/{UNIT}"]  # it also says since when several sessions show an effect, in UTC
    assert {path for path, page in shown.items() if OTHER_DAY.search(page)} == set()
    papers = {
        path: client.get(path).raise_for_status().text
        for path in (f"{api}/certificate?format=dcc", f"{api}/correction")
    }
    assert {path for path, text in papers.items() if OTHER_DAY.search(text)} == set()
    assert "2026-03-01" in papers[f"{api}/certificate?format=dcc"]
    assert "2026-02-28T22:30:00" in client.get(f"/api/v1/units/{UNIT}/history?format=csv").text


@one_engine
def test_the_due_day_is_the_same_everywhere(holding: Holding) -> None:
    client = holding(session_bytes(started_at=EARLY))
    due = datetime.fromisoformat(client.get("/api/v1/units", params={"q": UNIT}).json()["units"][0]["due"])
    assert (due - MOMENT) % timedelta(days=1) == timedelta()
    calendar = client.get("/api/v1/feeds/due.ics").text
    assert f"DTSTART;VALUE=DATE:{due:%Y%m%d}" in calendar
    label = text_of(client.get(f"/api/v1/units/{UNIT}/label.pdf").raise_for_status().content)
    assert f"{due.day} {due:%b %Y}" in label
    assert f"{due.day} {due:%b %Y}" in client.get(f"/units/{UNIT}", headers=HTML).text


@pytest.mark.parametrize(
    ("stated", "expected"),
    [
        ("2026-03-01T01:30:00+05:30", "2026-02-28T20:00:00Z"),
        ("2026-02-28T23:00:00-03:45", "2026-03-01T02:45:00Z"),
        ("2026-03-01T01:30:00.25Z", "2026-03-01T01:30:00.250000Z"),
        ("1950-01-01T00:00:00+14:00", "1949-12-31T10:00:00Z"),
    ],
)
def test_a_file_s_moment_is_kept_with_its_offset(stated: str, expected: str) -> None:
    kept = read_session(json.loads(session_bytes(started_at=stated))).started_at
    assert kept is not None
    assert written(moment(kept)) == expected
    assert local_moment(kept).utcoffset() == datetime.fromisoformat(stated).utcoffset()


@pytest.mark.parametrize(
    "stated",
    ["2026-03-01", "2026-03-01T09:00:00", "0001-01-01T00:00:00+03:00", "9999-12-31T23:00:00-03:00", "at noon", ""],
)
def test_a_moment_that_is_none_is_refused_with_its_field(client: httpx.Client, stated: str) -> None:
    content = session_bytes(started_at=stated)
    with pytest.raises(SessionError):
        read_session(json.loads(content))
    answer = client.post("/api/v1/sessions", content=content)
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "started_at")


@one_engine
@pytest.mark.parametrize("at", ["0001-01-01T00:00+03:00", "9999-12-31T23:00-03:00"])
def test_a_form_s_moment_that_no_calendar_holds_is_refused(client: httpx.Client, at: str) -> None:
    form = {"kind": "repair", "by": "K. Ito", "at": at}
    answer = client.post(f"/units/{UNIT}/services", data=form, headers=HTML)
    assert answer.status_code == 422
