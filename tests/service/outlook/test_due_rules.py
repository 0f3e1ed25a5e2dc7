"""The rule that set a unit's date is the sentence about it: on its page, its label, in the calendar and over HTTP."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime
from html import unescape

import httpx
import pytest
from icalendar import Calendar

from service.app import create_app
from service.kit.measures import day_of
from service.outlook.store import Outlooks, outlook_from_dicts, outlook_to_dicts
from service.records.changes import record_service
from service.settings import Settings
from service.storage import Storage
from service.units.records import NewService
from service.units.store import Units
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.dated import upload_and_date
from tests.service.made_sessions import session_bytes
from tests.service.papers.documents import text_of
from tests.serving import http_client

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
UNIT = "/api/v1/units/BA-017"
COARSE = {"id": "S-2", "alpha_deg": 40.0, "sigma_arcsec": dict.fromkeys(("theta_x", "theta_y", "alpha", "beta"), 600.0)}


@pytest.fixture
def client(settings: Settings) -> Iterator[httpx.Client]:
    """HTTP at a fixed time."""
    with http_client(create_app(settings, clock=lambda: NOW)) as http:
        yield http


def allow(client: httpx.Client, days: int) -> None:
    """Another longest interval of the unit's type."""
    kind = client.get("/api/v1/unit-types").json()["unit_types"][0]
    body = {"tolerances": kind["tolerances"], "maximum_interval_days": days}
    client.put(f"/api/v1/unit-types/{kind['name']}", json=body).raise_for_status()


def measure(storage: Storage, moved: dict[int, float], **changes: object) -> None:
    """Sessions by month of 2026, with how far A3's bias has moved, µg; 50 are allowed."""
    for month, micro_g in moved.items():
        content = session_bytes(seed=month, month=month, a3_moved=micro_g, **changes)
        upload_and_date(storage, content, "a.json", NOW, outlook=month == max(moved))


def undecided(storage: Storage) -> None:
    measure(storage, {1: 0.0})
    measure(storage, {2: 0.0}, stand=COARSE)


def serviced(storage: Storage) -> None:
    measure(storage, {1: 0.0, 3: 1.0})
    record_service(storage, "BA-017", NewService("repair", datetime(2026, 8, 1, tzinfo=UTC)), NOW)


@dataclass(frozen=True)
class Said:
    """Statements about a unit's date, wherever they stand."""

    due: date | None
    rule: str
    reason: str
    page: str
    label: str
    calendar: str | None
    called_for: date | None
    """The day in the calendar."""


def said(client: httpx.Client) -> Said:
    """All statements about the one unit's due date."""
    outlook = client.get(f"{UNIT}/outlook").raise_for_status().json()
    page = client.get("/units/BA-017", headers={"Accept": "text/html"}).raise_for_status().text
    label = text_of(client.get(f"{UNIT}/label.pdf").raise_for_status().content)
    events = Calendar.from_ical(client.get("/api/v1/feeds/due.ics").raise_for_status().content).walk("VEVENT")
    return Said(
        due=None if outlook["due"] is None else datetime.fromisoformat(outlook["due"]).date(),
        rule=outlook["basis"]["rule"],
        reason=outlook["reason"],
        page=unescape(page),
        label=" ".join(label.split()),
        calendar=str(events[0]["DESCRIPTION"]) if events else None,
        called_for=events[0].decoded("DTSTART") if events else None,
    )


DRIFTS = {1: 0.0, 3: 7.0, 5: 14.0, 7: 21.0, 9: 28.0}
CASES: dict[str, Callable[[Storage], None]] = {
    "no-trend": lambda storage: measure(storage, {1: 0.0}),
    "interval": lambda storage: measure(storage, dict.fromkeys((1, 4, 7, 10), 0.0)),
    "risk": lambda storage: measure(storage, DRIFTS),
    "may-be-out": lambda storage: measure(storage, {**DRIFTS, 10: 40.0, 11: 47.5}),
    "undecided": undecided,
    "unfit": lambda storage: measure(storage, {1: 0.0, 3: 90.0}),
    "serviced": serviced,
}


@pytest.mark.parametrize("rule", CASES)
def test_the_rule_is_said_everywhere_with_its_date(client: httpx.Client, storage: Storage, rule: str) -> None:
    CASES[rule](storage)
    if rule == "interval":
        allow(client, 100)
    found = said(client)
    assert found.rule == rule
    assert (found.reason in found.page) is (rule not in ("undecided", "unfit")), "what must be done first leads"
    assert (found.calendar is None) is (found.due is None)
    assert found.calendar is None or found.calendar.endswith(found.reason)
    assert found.called_for == found.due
    if found.due is None:
        assert "DO NOT USE" in found.label
    else:
        assert day_of(found.due) in found.page
        why = "Nothing was measured since the service" if rule == "serviced" else found.reason
        assert f"{day_of(found.due)} {why}" in found.label


def test_the_day_in_the_sentence_sets_the_due_date(client: httpx.Client, storage: Storage) -> None:
    """The day on which a risk reaches its level, or the day that an interval is counted from."""
    measure(storage, DRIFTS)
    found = said(client)
    assert found.due is not None
    assert f"reaches 5 % on {day_of(found.due)}; A3 bias contributes most." in found.reason


def test_an_interval_is_counted_from_the_day_in_the_sentence(client: httpx.Client, storage: Storage) -> None:
    CASES["interval"](storage)
    allow(client, 100)
    found = said(client)
    assert found.reason == "Last calibrated on 1 Oct 2026; calibrate at least every 100 days."
    assert found.due == date(2027, 1, 9)


def test_an_overdue_unit_is_refused_with_the_same_sentence(client: httpx.Client, storage: Storage) -> None:
    measure(storage, DRIFTS)
    allow(client, 30)
    found = said(client)
    assert found.rule == "interval"
    assert found.reason == "Last calibrated on 1 Sep 2026; calibrate at least every 30 days."
    reasons = client.get(f"{UNIT}/usable").json()["reasons"]
    assert f"Its calibration was due on 1 Oct 2026: calibrate it. {found.reason}" in reasons
    assert "Calibration overdue since 1 Oct 2026" in found.page


def test_an_outlook_of_an_earlier_version_is_still_read(client: httpx.Client, storage: Storage) -> None:
    measure(storage, DRIFTS)
    with storage.database.writing() as store:
        unit, found = Units(store).key("BA-017"), Outlooks(store).of_unit("BA-017")
        assert found is not None
        document, drawn = outlook_to_dicts(replace(found, reason="It is time."))
        del document["basis"]
        assert outlook_from_dicts(document, drawn).basis is None
        Outlooks(store).put(unit, outlook_from_dicts(document, drawn))
    answer = client.get(f"{UNIT}/outlook").raise_for_status().json()
    assert (answer["basis"], answer["reason"]) == (None, "It is time.")
    assert "It is time." in client.get("/units/BA-017", headers={"Accept": "text/html"}).text
