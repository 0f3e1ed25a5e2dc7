"""Every page, wide and narrow: quiet console, only our own requests, nothing wider than the screen."""

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Literal

import axe_playwright_python
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.end_to_end.browser.conftest import Site, Witness, draw_all, follow, open_all, opened
from tests.patience import LONG

pytestmark = pytest.mark.browser

PATHS = (
    "/",
    "/units/BA-017",
    "/sessions/{unfit}",
    "/sessions/{flown}",
    "/units/FL-1",
    "/sessions/{loose}/diagnosis",
    "/sessions/{swayed}/diagnosis",
    "/flags",
    "/due",
    "/register",
    "/stands",
    "/stands/ODG-1",
    "/sessions",
    "/compare?a={first}&b={unfit}",
    "/uploads",
    "/help",
    "/settings",
    "/unit-types",
    "/unit-types/accelerometer × 6, V",
    "/upload",
    "/plan",
    "/sign-in",
    "/accounts",
    "/account",
    "/audit",
    "/jobs",
    "/units/nobody",
)
LONG_AND_ALIKE = "/api-reference"
"""A page whose folds stay closed: axe takes a minute for hundreds that are made by one loop."""
MORE = (
    "/?q=BA&use=no",
    "/units/GB-004",
    "/units/RA-1",
    "/sessions/{loose}",
    "/sessions/{aligned}",
    "/sessions/{unfit}/diagnosis",
    "/sessions/{flown}/diagnosis",
    "/due?when=unknown",
    "/plan?kind=gyroscope&runs=direct&bias=0.05",
    LONG_AND_ALIKE,
)
"""Other units, sessions and lists on pages that stand above, and one that is long."""
EVERY_PATH = (*PATHS, *(pytest.param(path, marks=pytest.mark.slow) for path in MORE))


def address(site: Site, path: str) -> str:
    sessions = {"unfit": site.unfit_session, "loose": site.loose_session, "swayed": site.swayed_session}
    return site.url + path.format(
        **sessions, first=site.first_session, aligned=site.aligned_session, flown=site.flown_session
    )


HEIGHT = "document.documentElement.scrollHeight"
SCREENS = 3 * 900
"""Pixels: what the page of a unit, a session or a diagnosis takes at most on a wide screen, as it opens."""
WIDTHS = (390, 1280)
"""A phone, on which a page is opened, and then a wide screen."""


@dataclass(frozen=True)
class Seen:
    """One visit to a page."""

    complaints: tuple[str, ...]
    addresses: tuple[str, ...]
    """Addresses of its requests."""
    received: float
    """Bytes on the wire."""
    overflow: tuple[int, ...]
    """Pixels by which it is wider than the screen, at each width."""
    levels: tuple[int, ...]
    """Levels of its headings, in order."""
    nameless: int
    """Controls without a label."""
    height: int
    """Height of the page as it opens on a wide screen, pixels."""
    barriers: tuple[str, ...]
    """Barriers that axe finds on a wide screen with everything unfolded, in light colours."""


IN_RUSSIAN = ("/", "/units/BA-017", "/sessions/{unfit}", "/sessions/{swayed}/diagnosis", "/flags", "/upload", "/help")
"""Pages that are checked in Russian, whose words are longer."""
OVERFLOW = "document.documentElement.scrollWidth - window.innerWidth"
LEVELS = "[...document.querySelectorAll('h1,h2,h3')].map((h) => +h.tagName[1])"
CONTROLS = "[...document.querySelectorAll('input:not([type=hidden]),select')]"
AXE = (files(axe_playwright_python) / "axe.min.js").read_text(encoding="utf-8")
FAULTS: dict[str, Any] = {"resultTypes": ["violations"]}
"""Restricts axe's report to violations: it would otherwise name every sound element, which takes as long as looking."""
COLOURS = FAULTS | {"runOnly": ["color-contrast"]}
"""Restricts axe to the rules that dark colours decide."""
COLOURLESS = FAULTS | {"rules": {"color-contrast": {"enabled": False}}}
"""All others: no colour depends on the language, and hardly any on the width."""
EVERYTHING, NARROW = "html", ".cards, .filter"
"""Selectors: everything, and the parts shown or coloured differently on a narrow screen, where rows become cards."""
Scan = tuple[Literal["light", "dark"], dict[str, Any], str]
"""Colours, what axe looks for, and where."""
FIRST: Scan = ("light", FAULTS, EVERYTHING)
SCANS: dict[int, tuple[Scan, ...]] = {
    390: (("light", COLOURLESS, EVERYTHING), ("light", COLOURS, NARROW), ("dark", COLOURS, NARROW)),
    1280: (("dark", COLOURS, EVERYTHING),),
}
"""Scans of the parts that may differ from the first look, by width."""
VIOLATIONS = """async ([place, options]) => {
  if (!document.querySelector(place)) return [];
  const found = await axe.run(place, options);
  return found.violations.map((v) => `${v.id}: ${v.nodes[0].html} ${v.nodes[0].failureSummary}`);
}"""
NAMELESS = f"{CONTROLS}.filter((e) => !e.labels.length && !e.ariaLabel).length"


def visit(browser: Browser, site: Site, path: str) -> Seen:
    """A page opened for the first time, with all its charts."""
    witness = Witness()
    received: list[float] = []
    overflow = []
    with opened(browser, WIDTHS[0]) as (context, page):
        witness.watch(page)
        wire = context.new_cdp_session(page)
        wire.send("Network.enable")
        wire.on("Network.loadingFinished", lambda event: received.append(event["encodedDataLength"]))
        page.goto(address(site, path))
        page.set_viewport_size({"width": WIDTHS[1], "height": 900})
        draw_all(page)
        height = page.evaluate(HEIGHT)
        if path != LONG_AND_ALIKE:
            open_all(page)
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            draw_all(page)
            overflow.append(page.evaluate(OVERFLOW))
        barriers = barriers_of(page, [FIRST])
        levels, nameless = (page.evaluate(script) for script in (LEVELS, NAMELESS))
    complaints, addresses = tuple(witness.complaints), tuple(witness.addresses)
    return Seen(complaints, addresses, sum(received), tuple(overflow), tuple(levels), nameless, height, tuple(barriers))


def barriers_of(page: Page, scans: Iterable[Scan]) -> list[str]:
    """Barriers that axe finds on a page, with the element."""
    page.evaluate(AXE)
    found = []
    for scheme, rules, place in scans:
        page.emulate_media(color_scheme=scheme)
        found += [f"{scheme}: {one}" for one in page.evaluate(VIOLATIONS, [place, rules])]
    return found


@pytest.fixture(scope="module", params=EVERY_PATH)
def path(request: pytest.FixtureRequest) -> str:
    """Every page in turn."""
    chosen: str = request.param
    return chosen


@pytest.fixture(scope="module")
def seen(chromium: Browser, site: Site, path: str) -> Seen:
    """A visit on a phone and on a wide screen."""
    return visit(chromium, site, path)


def test_the_console_is_quiet(seen: Seen, path: str) -> None:
    assert [c for c in seen.complaints if path != "/units/nobody" or "404" not in c] == []


def test_only_our_own_service_is_asked(seen: Seen, site: Site) -> None:
    assert {address.startswith(site.url) for address in seen.addresses} == {True}


def test_a_unit_a_session_a_diagnosis_take_three_screens_at_most(seen: Seen, path: str) -> None:
    assert seen.height <= SCREENS or not path.startswith(("/units/", "/sessions/"))


def test_axe_finds_no_barrier(seen: Seen) -> None:
    assert seen.barriers == ()


@pytest.mark.slow
def test_axe_finds_no_barrier_on_a_phone_or_in_dark_colours(chromium: Browser, site: Site, path: str) -> None:
    found = []
    with opened(chromium, WIDTHS[0]) as (_, page):
        page.goto(address(site, path))
        if path != LONG_AND_ALIKE:
            open_all(page)
        for width, scans in SCANS.items():
            page.set_viewport_size({"width": width, "height": 900})
            draw_all(page)
            found += [f"{width}, {barrier}" for barrier in barriers_of(page, scans)]
    assert found == []


def test_nothing_is_wider_than_the_screen(seen: Seen) -> None:
    assert max(seen.overflow) <= 0


def test_first_load_is_light(seen: Seen) -> None:
    assert 0 < seen.received < 1.5e6


def test_headings_do_not_skip(seen: Seen) -> None:
    assert seen.levels.count(1) == 1
    assert all(after - before <= 1 for before, after in itertools.pairwise(seen.levels))


def test_every_control_has_a_name(seen: Seen) -> None:
    assert seen.nameless == 0


def test_verdict_and_reason_are_the_first_thing_said(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(address(site, "/sessions/{unfit}"))
        assert "Unfit" in page.locator("h1").inner_text()
        assert "A3 bias" in page.locator(".reason").inner_text()
        box = page.locator(".verdict").bounding_box()
        assert box is not None
        assert box["y"] < 250


def test_fleet_lists_the_worst_unit_first(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(site.url)
        first = page.locator("table.units tbody tr").first.inner_text()
        assert "FL-1" in first
        assert "Do not use" in first
        assert "A3 bias" in first


def test_a_count_shows_only_its_units(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(site.url)
        count = int(page.locator(".tally .use.no b").inner_text())
        follow(page.locator(".tally .use.no"))
        shown = page.locator("table.units tbody .badge").all_inner_texts()
        assert shown == count * ["Do not use"]


@pytest.mark.parametrize(("width", "height"), [(1280, 900), (390, 844)])
def test_units_are_seen_without_scrolling(chromium: Browser, site: Site, width: int, height: int) -> None:
    with opened(chromium, width) as (_, page):
        page.set_viewport_size({"width": width, "height": height})
        page.goto(site.url)
        box = page.locator("table.units tbody tr").first.bounding_box()
        assert box is not None
        assert box["y"] + box["height"] < height


@pytest.mark.parametrize("width", [1280, 390])
def test_a_unit_s_page_begins_with_its_use_and_the_worst_parameter(chromium: Browser, site: Site, width: int) -> None:
    with opened(chromium, width) as (_, page):
        page.goto(f"{site.url}/units/BA-017")
        assert "Do not use" in page.locator("h1").inner_text()
        assert "A3 bias" in page.locator(".lead-answer").inner_text()
        box = page.locator(".lead-answer .worst .chart").bounding_box()
        assert box is not None
        assert box["y"] < 750


def test_reading_needs_no_script(chromium: Browser, site: Site) -> None:
    with opened(chromium, java_script_enabled=False) as (_, page):
        page.goto(address(site, "/units/BA-017"))
        assert "Do not use" in page.locator("h1").inner_text()
        page.locator("details:has(> #bias-accelerometer) > summary").click()
        follow(page.locator("#bias-accelerometer a"))
        page.locator("#bias-accelerometer .twin summary").click()
        assert "µg" in page.locator("#bias-accelerometer table tbody tr").first.inner_text()


def test_a_folded_chart_is_drawn_when_it_comes_near(chromium: Browser, site: Site) -> None:
    last = "[...document.querySelectorAll('.chart')].at(-1)"
    with opened(chromium) as (_, page):
        page.goto(address(site, "/units/BA-017"))
        open_all(page)
        assert not page.evaluate(f"{last}.classList.contains('drawn')")
        page.evaluate(f"{last}.scrollIntoView({{ behavior: 'instant' }})")
        expect(page.locator(".chart").last).to_have_class(re.compile("drawn"), timeout=1000 * LONG)


def test_every_page_names_its_json_twin(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (context, page):
        for path in ("/", "/units/BA-017", "/sessions/{unfit}"):
            page.goto(address(site, path))
            twin = page.locator("link[rel=alternate][type='application/json']").get_attribute("href")
            assert context.request.get(site.url + str(twin)).json()


def test_everything_can_be_reached_by_keyboard(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(site.url)
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.textContent") == "Skip to the content"
        page.keyboard.press("Enter")
        page.wait_for_url("**/#content")


def test_two_sessions_are_chosen_on_the_unit_s_page(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(f"{site.url}/units/BA-017")
        page.locator("#compare summary").click()
        page.locator("#compare select[name=a]").select_option(site.first_session)
        follow(page.locator("#compare button"))
        assert "A3 bias changed by −8" in page.locator("main").inner_text()
        assert page.locator("tr.fail th").all_inner_texts() == ["A3 bias"]


def test_pages_in_russian_fit_and_hold_no_barrier(chromium: Browser, site: Site) -> None:
    witness, wider, barriers = Witness(), {}, []
    with opened(chromium, 390, locale="ru-RU") as (_, page):
        witness.watch(page)
        for path in IN_RUSSIAN:
            page.goto(address(site, path))
            open_all(page)
            assert page.locator("html").get_attribute("lang") == "ru"
            page.evaluate(AXE)
            for width in (390, 1024):
                page.set_viewport_size({"width": width, "height": 900})
                draw_all(page)
                wider[path, width] = page.evaluate(OVERFLOW)
                barriers += page.evaluate(VIOLATIONS, [EVERYTHING, COLOURLESS])
    assert {place: by for place, by in wider.items() if by} == {}
    assert barriers == []
    assert witness.complaints == []


@pytest.mark.parametrize("locale", ["en-GB", "ru-RU"])
def test_lists_fit_at_every_width_between(chromium: Browser, site: Site, locale: str) -> None:
    wider = {}
    with opened(chromium, locale=locale) as (_, page):
        for path in ("/", "/sessions", "/stands", "/settings", "/sessions/{unfit}"):
            page.goto(address(site, path))
            for width in (740, 860, 990, 1000, 1100, 1200):
                page.set_viewport_size({"width": width, "height": 900})
                wider[path, width] = page.evaluate(OVERFLOW)
    assert {place: by for place, by in wider.items() if by} == {}
