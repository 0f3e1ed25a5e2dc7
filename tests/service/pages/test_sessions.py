"""The list of sessions: its address, its pages, and what it shows."""

from dataclasses import replace

import httpx
import pytest

from service.fleet.records import FleetChoices
from service.pages.session.list_pages import sessions_page
from service.pages.session.view import SessionsView
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession
from tests.databases import one_engine
from tests.service.made_sessions import FAILED, session_id
from tests.service.pages.records import session_report

ASKED = SessionsView(
    q="BA",
    type="RA 6",
    since="2026-03-01",
    until="2026-03-31",
    state="withdrawn",
    verdict="fail",
    sort="-unit",
    after="x",
)


@pytest.fixture(scope="module")
def session() -> StoredSession:
    return session_report().session


def found(session: StoredSession, count: int) -> list[StoredSession]:
    return [replace(session, id=f"s{number}") for number in range(count)]


def test_a_view_comes_back_from_its_own_address() -> None:
    assert ASKED.url() == (
        "/sessions?q=BA&type=RA+6&since=2026-03-01&until=2026-03-31&state=withdrawn&verdict=fail&sort=-unit&after=x"
    )


def test_the_last_day_belongs_to_the_list() -> None:
    query = ASKED.query()
    assert query.since is not None
    assert query.until is not None
    assert (query.since.isoformat(), query.until.isoformat()) == (
        "2026-03-01T00:00:00+00:00", "2026-04-01T00:00:00+00:00",
    )  # fmt: skip


@pytest.mark.parametrize("day", ["soon", "2026-02-30", "9999-12-31", "\u0661"])
def test_what_nobody_knows_is_left_out(day: str) -> None:
    assert SessionsView(since=day, until=day, state="odd", verdict="odd", sort="colour").url() == "/sessions"


def test_a_reference_is_not_undecided() -> None:
    queries = [SessionsView(verdict=word).query() for word in ("reference", "undecidable")]
    assert [(q.verdict, q.is_reference) for q in queries] == [(Verdict.UNDECIDABLE, True), (Verdict.UNDECIDABLE, False)]


MORE = SessionsView.PAGE_SIZE + 1
"""Sessions than fit on a page."""


@pytest.mark.parametrize(
    ("view", "count", "ways"),
    [
        (SessionsView(), 3, ("", "")),
        (SessionsView(), MORE, ("", f"/sessions?after=s{MORE - 2}")),
        (SessionsView(after="x"), 3, ("/sessions?before=s0", "")),
        (SessionsView(before="x"), MORE, ("/sessions?before=s1", f"/sessions?after=s{MORE - 1}")),
        (SessionsView(before="x"), 3, ("", "/sessions?after=s2")),
        (SessionsView(after="x"), 0, ("", "")),
    ],
)
def test_pages_lead_to_one_another(
    session: StoredSession, view: SessionsView, count: int, ways: tuple[str, str]
) -> None:
    page = sessions_page(found(session, count), view, FleetChoices())
    assert (page.shown.earlier, page.shown.later) == ways
    assert len(page.lines) == min(count, SessionsView.PAGE_SIZE)


def test_the_list_is_narrowed_by_its_address(flagged: httpx.Client) -> None:
    ids = [session_id(content) for content in FAILED]
    shown = {path: [id in flagged.get(path).text for id in ids] for path in ("/sessions", "/sessions?verdict=fail")}
    assert shown == {"/sessions": [True, True], "/sessions?verdict=fail": [False, True]}
    assert "No session matches" in flagged.get("/sessions?stand=none").text


@one_engine
def test_an_empty_list_leads_to_the_upload(client: httpx.Client) -> None:
    assert 'No session yet. <a href="/upload">' in client.get("/sessions").text
