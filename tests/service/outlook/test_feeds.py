"""The calendar of due dates: read by other programs' own readers, exact to the letter of its standard."""

from datetime import UTC, date, datetime
from unicodedata import category
from uuid import NAMESPACE_URL, uuid5

from hypothesis import example, given, settings
from hypothesis import strategies as st
from icalendar import Calendar

from service.outlook.api import DueDay, calendar
from tests.conftest import Holding
from tests.service.made_sessions import FAILED, session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=200)


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


def printable(text: str) -> str:
    """The characters of a text that a calendar can hold."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n")
    return "".join(c if c in "\n\t" or category(c) not in ("Cc", "Zl", "Zp") else " " for c in lines)
