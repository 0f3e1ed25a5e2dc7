"""Feeds: read by other programs' own readers, exact to the letter of their standards."""

from datetime import UTC, date, datetime
from uuid import NAMESPACE_URL, uuid5
from xml.etree import ElementTree

import httpx
from hypothesis import example, given, settings
from hypothesis import strategies as st
from icalendar import Calendar

from service.api.atom import atom_feed
from service.api.calendar import DueDay, calendar
from service.records.flag import Notice, NoticeKind
from tests.conftest import Holding
from tests.service.sessions import FAILED, session_bytes

ATOM = {"a": "http://www.w3.org/2005/Atom"}
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=200)


def texts(feed: ElementTree.Element, path: str) -> list[str | None]:
    return [found.text for found in feed.findall(path, ATOM)]


def test_an_empty_feed_can_be_read(client: httpx.Client) -> None:
    empty = client.get("/api/v1/feeds/flags.atom")
    assert empty.headers["content-type"] == "application/atom+xml"
    assert texts(ElementTree.fromstring(empty.content), "a:entry/a:title") == []


def test_flags_and_verdicts_come_as_a_feed_newest_first(holding: Holding) -> None:
    client = holding(*FAILED)
    client.post("/api/v1/flags/1/resolve", json={"by": "K. Ito", "why": "<cable> & plug"}).raise_for_status()
    feed = ElementTree.fromstring(client.get("/api/v1/feeds/flags.atom").content)
    assert texts(feed, "a:entry/a:title") == [
        "BA-017: flag resolved",
        "BA-017: flag raised",
        "BA-017: verdict changed",
    ]
    assert texts(feed, "a:entry/a:content")[0] == "<cable> & plug"
    assert texts(feed, "a:entry/a:author/a:name") == ["K. Ito", "imu-health", "imu-health"]
    again = ElementTree.fromstring(client.get("/api/v1/feeds/flags.atom").content)
    ids = texts(feed, "a:entry/a:id")
    assert ids == texts(again, "a:entry/a:id")
    assert len(set(ids)) == 3
    link = feed.find("a:entry/a:link", ATOM)
    assert link is not None
    assert client.get(link.attrib["href"], headers={"Accept": "text/html"}).status_code == 200


@given(unit=TEXT, text=TEXT)
@settings(deadline=None)
def test_any_text_makes_a_feed_that_can_be_read(unit: str, text: str) -> None:
    notice = Notice(1, unit, 1, NoticeKind.RAISED, NOW, "w", text, None)
    feed = ElementTree.fromstring(atom_feed([notice], "http://a/", "http://a/"))
    assert len(feed.findall("a:entry", ATOM)) == 1


def test_a_unit_that_is_found_unfit_waits_for_no_date(holding: Holding) -> None:
    client = holding(*FAILED)
    assert client.get("/api/v1/units/BA-017/outlook").json()["action"] == "act-now"
    assert list(Calendar.from_ical(client.get("/api/v1/feeds/due.ics").content).events) == []


def test_due_dates_come_as_a_calendar(holding: Holding) -> None:
    client = holding(session_bytes(month=1, seed=1), session_bytes(month=2, seed=2))
    answer = client.get("/api/v1/feeds/due.ics")
    assert answer.headers["content-type"] == "text/calendar; charset=utf-8"
    [event] = Calendar.from_ical(answer.content).events
    due = client.get("/api/v1/units/BA-017/outlook").json()["due"]
    assert event.start.isoformat() == due[:10]
    assert str(event["SUMMARY"]).startswith("BA-017: calibration ")
    [again] = Calendar.from_ical(client.get("/api/v1/feeds/due.ics").content).events
    assert event["UID"] == again["UID"]


@given(unit=TEXT, summary=TEXT, description=TEXT)
@example(unit="A", summary="C:\\New", description="\\\\N, \\n; \n")
@settings(deadline=None)
def test_any_text_survives_folding_and_escaping(unit: str, summary: str, description: str) -> None:
    content = calendar([DueDay(unit, date(2026, 3, 1), summary, description, "http://a/")], NOW)
    lines = content.split(b"\r\n")
    assert all(len(line) <= 75 and b"\n" not in line and b"\r" not in line for line in lines)
    assert all(line.decode() is not None for line in lines)
    [event] = Calendar.from_ical(content).events
    assert str(event.get("SUMMARY", "")) == printable(summary)
    assert str(event.get("DESCRIPTION", "")) == printable(description)
    assert event.start == date(2026, 3, 1)


def test_an_event_is_written_to_the_letter() -> None:
    day = DueDay("BA-017", date(2026, 12, 31), "BA-017: due", "a, b; C:\\New\nand on", "http://a/units/BA-017")
    assert calendar([day], NOW).decode().split("\r\n")[6:-2] == [
        "BEGIN:VEVENT",
        f"UID:{uuid5(NAMESPACE_URL, 'imu-health/due/BA-017')}@imu-health",
        "DTSTAMP:20261121T120000Z",
        "DTSTART;VALUE=DATE:20261231",
        "DTEND;VALUE=DATE:20270101",
        "SUMMARY:BA-017: due",
        r"DESCRIPTION:a\, b\; C:\\New\nand on",
        "URL:http://a/units/BA-017",
        "TRANSP:TRANSPARENT",
        "END:VEVENT",
    ]


def test_an_entry_is_written_to_the_letter() -> None:
    notice = Notice(1, "BA 017", 1, NoticeKind.RAISED, NOW, "K. <Ito>", "a & b", None)
    feed = ElementTree.canonicalize(atom_feed([notice], "http://a/feed", "http://a/").decode(), strip_text=True)
    assert feed.partition("</author>")[2] == (
        f"<entry><id>urn:uuid:{notice.key}</id><title>BA 017: flag raised</title>"
        "<updated>2026-11-21T12:00:00+00:00</updated>"
        '<link href="http://a/units/BA%20017#flags" rel="alternate"></link>'
        '<category term="flag.raised"></category><author><name>K. &lt;Ito&gt;</name></author>'
        '<content type="text">a &amp; b</content></entry></feed>'
    )


def test_a_feed_without_entries_still_has_a_date() -> None:
    feed = ElementTree.fromstring(atom_feed([], "http://a/feed", "http://a/"))
    assert texts(feed, "a:updated") == ["1970-01-01T00:00:00+00:00"]


def printable(text: str) -> str:
    """What a calendar can hold of a text."""
    return "".join(c for c in text if (c >= " " and c != "\x7f") or c == "\n")
