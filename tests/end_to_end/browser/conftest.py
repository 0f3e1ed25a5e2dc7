"""A service with a small fleet, and a Chromium to look at it with."""

import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

import httpx
import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Locator, Page, Request, expect, sync_playwright

from service.uploads.receive import upload as receive
from tests.builders import Document, accelerometer_block, arbitrary_orientations, gyro_block, true_sensors
from tests.conftest import StockOf
from tests.databases import Databases
from tests.patience import LONG
from tests.service.diagnosed import swaying_stand
from tests.service.made_sessions import session_bytes
from tests.service.recordings import recording_document
from tests.service.turntable import alignment_bytes
from tests.serving import serving
from tests.stock import stores

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
MICRO_G = 9.80665e-6
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


@dataclass(frozen=True)
class Site:
    """Address of the service, and its contents."""

    url: str
    first_session: str
    """Session of the unit that has been unfit since."""
    unfit_session: str
    loose_session: str
    swayed_session: str
    aligned_session: str
    flown_session: str


def drifting(step: int) -> Document:
    """Session ``step`` of a unit whose A3 loses 14 µg of bias from each to the next."""
    sensors = true_sensors(6, bias=1e-3, quadratic=1e-6, tilt=1e-4)
    sensors[2] = replace(sensors[2], bias=sensors[2].bias - 14 * MICRO_G * step)
    document = accelerometer_block(positions=24, sensors=sensors, seed=10 + step)
    return document | {"started_at": f"202{4 + step // 4}-{1 + 3 * (step % 4):02}-15T09:00:00Z"}


def earlier() -> Iterator[Document]:
    """Sessions whose own pages are not opened."""
    yield from map(drifting, range(6))
    for seed in (1, 2):
        yield accelerometer_block(unit="BA-018", seed=seed) | {"started_at": f"2026-0{seed}-01T08:00:00Z"}
    yield gyro_block() | {"unit": "GB-004"}
    yield json.loads(alignment_bytes())
    yield json.loads(session_bytes(unit="FL-1"))


def upload(url: str, document: Document) -> str:
    """Uploads a session and returns its id."""
    answer = httpx.post(f"{url}/api/v1/sessions", content=json.dumps(document))
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


@pytest.fixture(scope="session")
def site(sqlite: Databases, stock_of: StockOf) -> Iterator[Site]:
    """A service with seven units: drifted, two fit, measured by hand, on a bad stand, aligned on a turntable, flown."""
    with stock_of(sqlite).holding() as settings, serving(settings) as url, stores(settings) as storage:
        before = [receive(storage, json.dumps(one).encode(), "earlier.json", NOW).id for one in earlier()]
        unfit = upload(url, drifting(6))
        loose = upload(url, arbitrary_orientations() | {"unit": "HAND-1"})
        swayed = upload(url, swaying_stand())
        aligned = upload(url, json.loads(alignment_bytes(seed=2, month=4)))
        flown = upload(url, recording_document(unit="FL-1", a3_moved=400.0))
        yield Site(url, before[0], unfit, loose, swayed, aligned, flown)


@pytest.fixture(scope="package")
def chromium() -> Iterator[Browser]:
    """An installed Chromium; without one the browser tests are skipped, but not where CI is set.

    Playwright's event loop counts as running until it is stopped: it must not outlive the tests that open pages.
    """
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        missing = pytest.fail if os.environ.get("CI") else pytest.skip
        missing("No Chromium is installed (looked for " + ", ".join(NAMES) + "): pages cannot be opened.")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=list(FLAGS))
        yield browser
        browser.close()


@dataclass
class Witness:
    """Record of events while pages were open."""

    complaints: list[str] = field(default_factory=list)
    """Errors and warnings of the console, failed requests."""
    addresses: list[str] = field(default_factory=list)

    def watch(self, page: Page) -> None:
        """Listens to a page from now on."""
        page.on("console", self._heard)
        page.on("pageerror", lambda fault: self.complaints.append(str(fault)))
        page.on("requestfailed", self._failed)
        page.on("request", lambda request: self.addresses.append(request.url))

    def _heard(self, message: ConsoleMessage) -> None:
        if message.type in ("error", "warning"):
            self.complaints.append(message.text)

    def _failed(self, request: Request) -> None:
        """Records a failed request; one that the browser cancelled, leaving a page before its icon came, is no
        failure.
        """
        if request.failure != "net::ERR_ABORTED":
            self.complaints.append(f"failed: {request.url}: {request.failure}")


@contextmanager
def opened(browser: Browser, width: int = 1280, **options: object) -> Iterator[tuple[BrowserContext, Page]]:
    """A fresh browser context with one page, which scrolls at once."""
    context = browser.new_context(viewport={"width": width, "height": 900}, reduced_motion="reduce", **options)
    context.set_default_timeout(1000 * LONG)
    yield context, context.new_page()
    context.close()


def follow(way: Locator) -> None:
    """Clicks a link or the button of a form, and waits for the page that it leads to (a click does not)."""
    with way.page.expect_navigation():
        way.click()


def draw_all(page: Page) -> None:
    """Draws every chart that is not folded, as before a page is printed, and waits for it.

    Nothing here waits for a frame: on a busy machine a headless browser may stop to paint for minutes.
    """
    fetched(page)
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    expect(page.locator(UNDRAWN)).to_have_count(0, timeout=1000 * LONG)


def open_all(page: Page) -> None:
    """Opens every fold, and those that come with what an opened one holds."""
    page.evaluate(OPEN_ALL)
    fetched(page)
    page.evaluate(OPEN_ALL)


def fetched(page: Page) -> None:
    """Waits until what stands open is there."""
    expect(page.locator("details[open] > .awaited")).to_have_count(0, timeout=1000 * LONG)


OPEN_ALL = "document.querySelectorAll('details').forEach((one) => { one.open = true; })"
UNDRAWN = (
    "xpath=//div[contains(concat(' ', @class, ' '), ' chart ')]"
    "[not(contains(@class, 'drawn') or ancestor::details[not(@open)])]"
)
"""A function to wait for is text that the page's own policy does not let run, so a locator waits."""
