"""The pictures of the documentation, taken of the demonstration fleet when they are asked for."""

import json
import os
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import httpx
import pytest
import typst
from playwright.sync_api import Browser, Page

from service.demo.fill import fill
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.kit.printable import printable_data
from service.papers.certificate import drawn_certificate
from service.papers.certified import certified_session
from service.papers.changes import issue_certificate
from service.papers.desk import statement_of
from service.papers.records import Laboratory
from service.papers.typeset import TEMPLATES
from service.records.diagnose import diagnose
from service.settings import Settings
from tests.databases import Databases
from tests.docs import bench
from tests.end_to_end.browser.conftest import draw_all, opened
from tests.serving import serving
from tests.stock import stores

ASKED = "IMU_HEALTH_PICTURES"
DOCS = Path(__file__).parents[3] / "docs"
FOLDER, EXAMPLE = DOCS / "pictures", DOCS / "examples" / "bench.xlsx"
UNIT = "BA-107"
"""A4 wore out and was replaced: its history has a break."""
STICKING = "BA-110"
"""A4 sticks since the last session, which the diagnosis names."""
NOW = datetime(2026, 11, 21, tzinfo=UTC)
LABORATORY = Laboratory("Inertial Laboratory North", "4 Gyro Street, 20095 Hamburg", "DE")

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(not os.environ.get(ASKED), reason=f"writes docs/pictures; set {ASKED}=1 to take them"),
]


@pytest.fixture(scope="module")
def filled(sqlite: Databases, tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """Settings of a service that holds the demonstration fleet."""
    settings = Settings(database_url=sqlite.migrated(), data_folder=tmp_path_factory.mktemp("demonstration"))
    with stores(settings) as storage:
        fill(storage, settings.coverage_factor, lambda: None)
    return settings


@pytest.fixture(scope="module")
def demonstration(filled: Settings) -> Iterator[str]:
    """A service with the demonstration fleet."""
    with serving(filled) as url:
        yield url


def test_picture_of_the_first_page_of_a_certificate(filled: Settings) -> None:
    with stores(filled) as storage:
        with storage.database.reading() as store:
            worst = Fleet(store).units(FleetQuery(limit=1))[0].last_session
        assert worst is not None
        found = certified_session(storage, diagnose(storage, worst, NOW), LABORATORY)
        issue = issue_certificate(storage, statement_of(found), NOW, who="K. Ito")
        record = printable_data(drawn_certificate(found, issue))
    pages = typst.compile(
        TEMPLATES / "certificate.typ",
        root=TEMPLATES,
        format="png",
        ppi=110,
        sys_inputs={"data": json.dumps(record), "words": json.dumps({"language": "en", "said": {}})},
        ignore_system_fonts=True,
    )
    assert isinstance(pages, list)
    (FOLDER / "certificate.png").write_bytes(pages[0])


@pytest.mark.parametrize(
    ("name", "path", "width", "height"),
    [
        ("fleet", "/", 1280, 1080),
        ("fleet-phone", "/", 390, 844),
        ("unit", f"/units/{UNIT}", 1280, 1500),
        ("session", "/sessions/{last}", 1280, 1500),
        ("diagnosis", "/sessions/{sticking}/diagnosis", 1280, 1500),
        ("plan", "/plan", 1280, 1500),
        ("upload", "/upload", 1280, 560),
    ],
)
def test_picture(chromium: Browser, demonstration: str, name: str, path: str, width: int, height: int) -> None:
    units = httpx.get(f"{demonstration}/api/v1/units").json()["units"]
    sticking = next(unit["last_session"] for unit in units if unit["serial"] == STICKING)
    with opened(chromium, width) as (_, page):
        page.set_viewport_size({"width": width, "height": height})
        page.goto(demonstration + path.format(last=units[0]["last_session"], sticking=sticking))
        draw_all(page)
        FOLDER.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=FOLDER / f"{name}.png")
    assert (FOLDER / f"{name}.png").stat().st_size > 10_000


def test_pictures_of_the_tutorial(chromium: Browser, demonstration: str) -> None:
    """The last ones: what they upload is on no other picture."""
    EXAMPLE.parent.mkdir(exist_ok=True)
    EXAMPLE.write_bytes(bench.workbook())
    with opened(chromium, 1280) as (_, page):
        page.goto(f"{demonstration}/upload")
        page.set_input_files("#files", EXAMPLE)
        for label, text in bench.FACTS.items():
            page.get_by_label(label).fill(text)
        page.get_by_label("Axes").select_option("cone")
        taken(page, "own-columns", 1500)
        page.get_by_role("button", name="Look again").click()
        preview = page.get_by_text("measured 9.8").locator("xpath=ancestor::section")
        preview.screenshot(path=FOLDER / "own-preview.png")
        page.get_by_role("button", name="Store it", exact=True).click()
        page.get_by_role("heading", name="Reference set").wait_for()
        session = f"{demonstration}/sessions/{newest(demonstration)}"
        page.goto(f"{session}/diagnosis")
        taken(page, "own-diagnosis", 1300)
        page.goto(session)
        taken(page, "own-session", 1300)


def newest(address: str) -> str:
    """Id of the session that was uploaded last."""
    found = httpx.get(f"{address}/api/v1/uploads", params={"limit": 1}).json()["uploads"]
    return str(found[0]["id"])


def taken(page: Page, name: str, height: int) -> None:
    """A picture of what is seen of a page."""
    page.set_viewport_size({"width": 1280, "height": height})
    draw_all(page)
    page.evaluate("scrollTo(0, 0)")
    page.screenshot(path=FOLDER / f"{name}.png")
