"""Every page, wide and narrow: quiet console, only our own requests, nothing wider than the screen."""

import itertools

import pytest
from playwright.sync_api import Browser

from tests.end_to_end.browser.conftest import Site, Witness, draw_all, opened

pytestmark = pytest.mark.browser

PATHS = (
    "/",
    "/?q=BA&condition=fail",
    "/units/BA-017",
    "/units/GB-004",
    "/sessions/{unfit}",
    "/sessions/{loose}",
    "/sessions/{aligned}",
    "/sessions/{flown}",
    "/units/RA-1",
    "/units/FL-1",
    "/sessions/{unfit}/diagnosis",
    "/sessions/{flown}/diagnosis",
    "/sessions/{loose}/diagnosis",
    "/flags",
    "/upload",
    "/plan",
    "/plan?kind=gyroscope&runs=direct&bias=0.05",
    "/units/nobody",
)


def address(site: Site, path: str) -> str:
    sessions = {"unfit": site.unfit_session, "loose": site.loose_session}
    return site.url + path.format(**sessions, aligned=site.aligned_session, flown=site.flown_session)


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("width", [1280, 390])
def test_page_is_whole(chromium: Browser, site: Site, path: str, width: int) -> None:
    witness = Witness()
    with opened(chromium, width) as (_, page):
        witness.watch(page)
        page.goto(address(site, path))
        draw_all(page)
        overflow = page.evaluate("document.documentElement.scrollWidth - window.innerWidth")
    expected = [c for c in witness.complaints if path != "/units/nobody" or "404" not in c]
    assert expected == []
    assert [a for a in witness.addresses if not a.startswith(site.url)] == []
    assert overflow <= 0


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
        assert "Unfit" in first
        assert "A3 bias" in first


def test_tile_shows_only_its_condition(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(site.url)
        page.locator(".tile.fail").click()
        assert page.locator("table.units tbody th a:not(.tag)").all_inner_texts() == ["FL-1", "BA-017"]


def test_reading_needs_no_script(chromium: Browser, site: Site) -> None:
    with opened(chromium, java_script_enabled=False) as (_, page):
        page.goto(address(site, "/units/BA-017"))
        assert "Unfit" in page.locator("h1").inner_text()
        page.locator("#bias-accelerometer summary").click()
        assert "µg" in page.locator("#bias-accelerometer table tbody tr").first.inner_text()


def test_every_page_names_its_json_twin(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (context, page):
        for path in ("/", "/units/BA-017", "/sessions/{unfit}"):
            page.goto(address(site, path))
            twin = page.locator("link[rel=alternate][type='application/json']").get_attribute("href")
            assert context.request.get(site.url + str(twin)).json()


def test_first_load_is_light(chromium: Browser, site: Site) -> None:
    for path in PATHS:
        with opened(chromium) as (context, page):
            received: list[float] = []
            wire = context.new_cdp_session(page)
            wire.send("Network.enable")
            wire.on("Network.loadingFinished", lambda event, sizes=received: sizes.append(event["encodedDataLength"]))
            page.goto(address(site, path))
            draw_all(page)
            assert 0 < sum(received) < 1.5e6, path


def test_everything_can_be_reached_by_keyboard(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(site.url)
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.textContent") == "Skip to the content"
        page.keyboard.press("Enter")
        page.wait_for_url("**/#content")


def test_every_control_has_a_name_and_headings_do_not_skip(chromium: Browser, site: Site) -> None:
    nameless = "[...document.querySelectorAll('input,select')].filter((e) => !e.labels.length).length"
    levels = "[...document.querySelectorAll('h1,h2,h3')].map((h) => +h.tagName[1])"
    for path in PATHS:
        with opened(chromium) as (_, page):
            page.goto(address(site, path))
            found = page.evaluate(levels)
            assert found.count(1) == 1, path
            assert all(after - before <= 1 for before, after in itertools.pairwise(found)), path
            assert page.evaluate(nameless) == 0, path
