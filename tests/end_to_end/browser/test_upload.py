"""Uploading in the browser: the verdict, or every problem with its row."""

import json
from itertools import chain, repeat
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from tests.builders import accelerometer_block
from tests.end_to_end.browser.conftest import Site, Witness, follow, opened

pytestmark = pytest.mark.browser


@pytest.fixture
def good(tmp_path: Path) -> Path:
    path = tmp_path / "BA-020.json"
    path.write_text(json.dumps(accelerometer_block(unit="BA-020", seed=20)))
    return path


@pytest.fixture
def faulty(tmp_path: Path) -> Path:
    """Three faults: a reading that is text, a negative standard error, an α of 90°."""
    document = accelerometer_block(unit="BA-021")
    document["table"]["A3"][6] = "n/a"
    document["table"]["A2_se"][2] = -1e-6
    document["stand"]["alpha_deg"] = 90.0
    path = tmp_path / "faulty.json"
    path.write_text(json.dumps(document))
    return path


def places(page: Page) -> list[tuple[str, str]]:
    rows = [r.locator("td").all_inner_texts() for r in page.locator(".problems tbody tr").all()]
    return [(cells[0], cells[1]) for cells in rows]


def test_several_files_at_once_give_a_verdict_or_problems_each(
    chromium: Browser, site: Site, good: Path, faulty: Path
) -> None:
    witness = Witness()
    with opened(chromium) as (_, page):
        witness.watch(page)
        page.goto(f"{site.url}/upload")
        page.set_input_files("#files", [good, faulty])
        page.locator(".outcome.refused h3").wait_for()
        page.locator(".outcome", has_text="BA-020").locator("a", has_text="Open the session").wait_for()
        found = places(page)
    assert {("A3", "7"), ("A2_se", "3"), ("stand.alpha_deg", "")} <= set(found)
    assert [c for c in witness.complaints if "422" not in c] == []


def test_dropped_file_is_uploaded(chromium: Browser, site: Site, good: Path) -> None:
    with opened(chromium) as (_, page):
        page.goto(f"{site.url}/upload")
        transfer = page.evaluate_handle(
            "(text) => { const t = new DataTransfer(); t.items.add(new File([text], 'dropped.json')); return t; }",
            good.read_text(),
        )
        page.dispatch_event("#upload", "drop", {"dataTransfer": transfer})
        follow(page.locator(".outcome a", has_text="Open the session"))
        assert "BA-020" in page.locator("h1").inner_text()


def test_upload_works_without_script(chromium: Browser, site: Site, good: Path, faulty: Path) -> None:
    with opened(chromium, java_script_enabled=False) as (_, page):
        page.goto(f"{site.url}/upload")
        page.set_input_files("#files", [good, faulty])
        follow(page.get_by_role("button", name="Upload"))
        assert ("A3", "7") in places(page)
        assert page.locator(".outcome", has_text="BA-020").count() == 1


def test_a_phone_shows_what_is_wrong_without_scrolling_sideways(chromium: Browser, site: Site, faulty: Path) -> None:
    with opened(chromium, width=390) as (_, page):
        page.goto(f"{site.url}/upload")
        page.set_input_files("#files", faulty)
        message = page.locator(".problems td", has_text="strictly between").first
        message.wait_for()
        box = message.bounding_box()
        assert box is not None
        assert box["x"] + box["width"] <= 390


def test_a_card_that_looks_the_same_for_a_while_is_replaced_at_last(chromium: Browser, site: Site, good: Path) -> None:
    card = '<article class="outcome" data-follow="/later" data-every="0.1">Reading</article>'
    answer = f'<div id="outcomes">{card}</div>'
    looks = chain([card, card], repeat('<article class="outcome">Stored at last</article>'))
    with opened(chromium) as (_, page):
        page.goto(f"{site.url}/upload")
        page.route("**/upload", lambda route: route.fulfill(body=answer, content_type="text/html"))
        page.route("**/later", lambda route: route.fulfill(body=next(looks), content_type="text/html"))
        page.set_input_files("#files", good)
        page.get_by_text("Stored at last").wait_for()
