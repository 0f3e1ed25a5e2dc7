"""A crew's bad days, walked on the pages: each ends in the right state, said in a sentence."""

import json
from collections.abc import Iterator
from datetime import UTC, datetime

import numpy as np
import pytest
from playwright.sync_api import Browser, Page
from scipy.spatial.transform import Rotation

from service.storage import Storage
from service.uploads.receive import upload
from tests.builders import ARCSEC, TrueSensor, accelerometer_block, true_sensors
from tests.conftest import StockOf
from tests.databases import Databases
from tests.end_to_end.browser.conftest import follow, opened
from tests.service.made_sessions import session_bytes
from tests.service.uploads.test_questioned import exchanged, slipped, times
from tests.serving import serving
from tests.stock import stores

pytestmark = pytest.mark.browser
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
BADLY = Rotation.from_rotvec(np.array([15.0, 0.0, -20.0]) * ARCSEC)
"""25″, as a fixture with dirt under it."""
LEANING = Rotation.from_rotvec(np.radians([2.0, 0.0, 0.0]))


def seated(turn: Rotation, unit: str, month: int, seed: int, stand: str = "S1") -> bytes:
    """A session of 2026 with the whole block turned in its fixture."""
    sensors = true_sensors(6, bias=1e-3, quadratic=1e-6, tilt=1e-4)
    axes = turn.apply(np.array([s.axis for s in sensors]))
    sensors = [TrueSensor(s.name, tuple(a), s.scale, s.bias, s.quadratic) for s, a in zip(sensors, axes, strict=True)]
    document = accelerometer_block(sensors=sensors, unit=unit, seed=seed, positions=24)
    document["stand"]["id"] = stand
    return json.dumps(document | {"started_at": f"2026-{month:02d}-01T09:00:00Z"}).encode()


def bad_month(storage: Storage) -> None:
    """Four units on one stand all year, badly seated in June."""
    for unit in range(4):
        for month in (1, 3, 5, 6, 8, 10):
            turn = BADLY if month == 6 else Rotation.identity()
            upload(storage, seated(turn, f"MO-{unit}", month, 10 * unit + month), "a.json", NOW)


@pytest.fixture(scope="module")
def crew(sqlite: Databases, stock_of: StockOf) -> Iterator[str]:
    """A service whose stand was seated badly for a month."""
    with stock_of(sqlite).holding() as settings, serving(settings) as url, stores(settings) as storage:
        bad_month(storage)
        yield url


@pytest.fixture
def page(chromium: Browser) -> Iterator[Page]:
    with opened(chromium) as (_, page):
        yield page


def uploaded(page: Page, url: str, content: bytes) -> None:
    """A file is dropped on the upload page and its session opened."""
    page.goto(f"{url}/upload")
    page.set_input_files("#files", {"name": "session.json", "mimeType": "application/json", "buffer": content})
    follow(page.locator(".outcome a", has_text="Open the session"))
    page.locator("section.verdict").wait_for()


def head(page: Page) -> str:
    """The verdict and why, as a page says it first."""
    return " ".join(page.locator("section:is(.verdict, .lead-answer)").inner_text().split())


def latest(page: Page) -> str:
    """The latest session that counts, in the list on a unit's page: its verdict first."""
    return " ".join(page.locator("#sessions tbody tr:not(.withdrawn)").first.inner_text().split())


def send(page: Page, heading: str, **fields: str) -> None:
    """Fills a form that lies behind its heading, and sends it."""
    details = page.locator("details.accept", has=page.locator("summary", has_text=heading))
    if details.get_attribute("open") is None:
        details.locator("summary").click()
    for name, value in ({"by": "K. Ito"} | fields).items():
        details.locator(f"[name={name}]").first.fill(value)
    follow(details.get_by_role("button"))


def test_readings_in_mv_are_put_right_by_one_button(crew: str, page: Page) -> None:
    uploaded(page, crew, slipped(times(1000.0), unit="MILLI-1"))
    assert "Questioned" in head(page)
    assert "the readings are not in the unit that the file states, such as mV instead of V" in head(page)
    send(page, "Correct the file")
    assert "Reference set" in head(page)


def test_a_faulty_file_as_the_first_session_sets_no_reference(crew: str, page: Page) -> None:
    uploaded(page, crew, slipped(exchanged, unit="EXCH-1"))
    assert "Questioned" in head(page)
    assert "their channels are exchanged" in head(page)
    page.goto(f"{crew}/units/EXCH-1")
    assert "None of its sessions counts as a calibration" in page.locator("main").inner_text()
    uploaded(page, crew, session_bytes(unit="EXCH-1", seed=2, month=4))
    assert "Reference set" in head(page)


def test_a_first_session_that_turns_out_bad_gives_way_to_a_better_reference(crew: str, page: Page) -> None:
    for month, moved in ((1, 300.0), (3, 0.0), (5, 0.0)):
        uploaded(page, crew, session_bytes(unit="FIRST-1", seed=month, month=month, a3_moved=moved))
    assert "Unfit" in head(page)
    page.goto(f"{crew}/units/FIRST-1")
    follow(page.locator("#sessions tbody th a").nth(1))
    send(page, "Make this session the reference", why="the first was measured warm")
    assert "Chosen as the reference" in head(page)
    page.goto(f"{crew}/units/FIRST-1")
    assert latest(page).startswith("Fit")
    assert "A3 is now judged against the session of 1 Mar 2026." in page.inner_text("main")


def test_a_service_entered_a_week_late_takes_the_fail_back(crew: str, page: Page) -> None:
    uploaded(page, crew, session_bytes(unit="SL-1", month=3))
    uploaded(page, crew, session_bytes(unit="SL-1", seed=2, month=5, a3_moved=300.0))
    assert "Unfit" in head(page)
    page.goto(f"{crew}/units/SL-1")
    send(page, "Record a service", at="2026-04-24T10:00")
    assert page.locator("h1").inner_text() == "What this service would change"
    follow(page.get_by_role("button", name="Record it"))
    assert "May be used with reservation" in head(page)


def test_a_session_of_the_wrong_unit_is_taken_back_and_leaves_nothing(crew: str, page: Page) -> None:
    uploaded(page, crew, session_bytes(unit="WU-1", month=3))
    uploaded(page, crew, session_bytes(unit="WU-1", seed=2, month=5, a3_moved=300.0))
    send(page, "Withdraw this session", why="measured on WU-2")
    assert "Withdrawn" in head(page)
    assert "by K. Ito: measured on WU-2" in head(page)
    page.goto(f"{crew}/units/WU-1")
    assert latest(page).startswith("Reference set")
    uploaded(page, crew, session_bytes(unit="WU-2", seed=2, month=5, a3_moved=300.0))
    assert "Reference set" in head(page)


def test_a_corrected_file_that_names_nothing_is_asked_which_of_the_two_counts(crew: str, page: Page) -> None:
    uploaded(page, crew, session_bytes(unit="TW-1", month=3))
    uploaded(page, crew, session_bytes(unit="TW-1", seed=2, month=5, a3_moved=300.0))
    uploaded(page, crew, session_bytes(unit="TW-1", seed=2, month=5))
    assert "was measured at the same moment" in head(page)
    send(page, "This file counts", why="A3 was read off wrongly")
    assert "Fit" in head(page)
    page.goto(f"{crew}/units/TW-1")
    assert latest(page).startswith("Fit")


def test_a_unit_mounted_otherwise_by_two_degrees_is_fit(crew: str, page: Page) -> None:
    for month, turn in ((3, Rotation.identity()), (5, LEANING)):
        uploaded(page, crew, seated(turn, "RM-1", month, 90 + month, "S9"))
    assert "Fit" in head(page)
    said = page.locator("p.line", has_text="The whole block turned by").inner_text()
    assert "turned by 1.9999" in said or "turned by 2.0000" in said
    assert "The sensors are judged without this effect" in said


def test_a_stand_seated_badly_for_a_month_is_named_with_its_dates(crew: str, page: Page) -> None:
    page.goto(f"{crew}/")
    said = page.locator("p.line", has_text="Stand S1 was shifted temporarily").inner_text()
    assert "from 1 Jun 2026 until before 1 Aug 2026" in said
    assert "The units are judged without this effect" in said
    page.goto(f"{crew}/units/MO-1")
    assert latest(page).startswith("Fit")
