"""The due list: by month, with where units are; it agrees with the calendar."""

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta

import fastexcel
import httpx
import polars as pl
import pytest

from service.app import create_app
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.pages.due.board import due_counts, period_in_words
from service.pages.due.view import DueView
from service.records.register import Entering, enter
from service.settings import Settings
from service.storage import Storage
from service.units.records import NewEntry
from tests.conftest import Filled, SettingsFilled
from tests.service.fleet.test_wanted_units import three_units
from tests.serving import http_client
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def test_every_unit_is_counted_in_one_period() -> None:
    dates = (None, NOW - timedelta(days=1), NOW, NOW + timedelta(days=20), NOW + timedelta(days=900))
    counts = due_counts(dates, NOW)
    assert [(one.when, one.units) for one in counts if one.units] == [
        ("overdue", 1), ("2026-11", 1), ("2026-12", 1), ("2029-05", 1), ("unknown", 1),
    ]  # fmt: skip
    assert [one.when for one in counts[1:13]][-1] == "2027-10"
    assert period_in_words("2026-12") == "Dec 2026"


def test_an_unknown_period_is_not_asked_for() -> None:
    assert DueView(when="2026-13").when == DueView(when="soon").when == ""
    wanted = DueView(when="2026-11").query(NOW)
    assert (wanted.due_since, wanted.due_before) == (NOW, datetime(2026, 12, 1, tzinfo=UTC))


def placed(storage: Storage) -> None:
    """Three units and one that was never measured."""
    three_units(storage)
    entries = (NewEntry("A-1", None, "Aero", "Hangar 2", "K. Ito"), NewEntry("D-1", "RA-9", "", "=Hangar"))
    enter(storage, entries, Entering("K. Ito", NOW))


def test_the_dates_are_those_of_the_list(filled: Filled) -> None:
    with filled(placed).database.reading() as store:
        units, dates = Fleet(store).units(FleetQuery()), Fleet(store).dates(FleetQuery())
    assert sorted(map(str, dates)) == sorted(str(unit.due) for unit in units)


def placed_by(settings: Settings) -> None:
    """Places them in a service of these settings."""
    with stores(settings) as storage:
        placed(storage)


@pytest.fixture
def http(settings_filled: SettingsFilled) -> Iterator[httpx.Client]:
    """HTTP to these."""
    with http_client(create_app(settings_filled(placed_by), clock=lambda: NOW)) as client:
        yield client


def test_the_list_agrees_with_the_calendar_and_says_where_units_are(http: httpx.Client) -> None:
    found = http.get("/api/v1/fleet/due").json()
    assert sum(one["units"] for one in found["counts"]) == 4
    calendar = http.get("/api/v1/feeds/due.ics").text
    days = {line["unit"]: line["due"][:10].replace("-", "") for line in found["units"]}
    assert len(days) == calendar.count("BEGIN:VEVENT") == 2
    assert all(f"DTSTART;VALUE=DATE:{day}" in calendar for day in days.values())
    assert [line["unit"] for line in http.get("/api/v1/fleet/due?location=Hangar+2").json()["units"]] == ["A-1"]
    unknown = http.get("/api/v1/fleet/due?when=unknown").json()["units"]
    assert {line["unit"] for line in unknown} == {"C-1", "D-1"}
    assert http.get("/api/v1/fleet/due?when=soon").status_code == 422


def test_the_files_have_dates_and_whole_days(http: httpx.Client) -> None:
    table = http.get("/api/v1/fleet/due?when=unknown&format=csv").text
    assert "D-1,RA-9,'=Hangar," in table
    days = pl.read_csv(http.get("/api/v1/fleet/due?format=csv").content)["days"].to_list()
    assert days == [line["days"] for line in http.get("/api/v1/fleet/due").json()["units"]]
    book = fastexcel.read_excel(http.get("/api/v1/fleet/due?format=xlsx").content)
    assert book.load_sheet(0).to_polars().height == 2


def test_the_page_has_a_tile_a_month_and_its_units(http: httpx.Client) -> None:
    page = http.get("/due")
    assert page.status_code == 200
    assert "Hangar 2" in page.text
    assert "D-1" not in page.text
    assert "D-1" in http.get("/due?when=unknown").text
    assert "No unit matches" in http.get("/due?when=2031-01").text
    assert "/due" in http.get("/").text
    why = http.get("/api/v1/fleet/due", headers={"Accept-Language": "ru"}).json()["units"][0]["why"]
    assert why.startswith("Риск выхода за допуск")
    assert why in http.get("/due?lang=ru").text
