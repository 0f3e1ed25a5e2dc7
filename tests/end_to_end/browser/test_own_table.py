"""Somebody's own workbook, from the upload page to its verdict, without reading anything."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser

from tests.end_to_end.browser.conftest import Site, Witness, opened
from tests.service import tables

pytestmark = pytest.mark.browser


@pytest.mark.parametrize("width", [1280, 390])
def test_a_workbook_of_ones_own_becomes_a_session(chromium: Browser, site: Site, tmp_path: Path, width: int) -> None:
    own, witness = tmp_path / "own.xlsx", Witness()
    document = tables.own_document()
    document["table"]["A1"][0] += width * 1e-9  # the same readings under another serial number would be asked about
    own.write_bytes(tables.xlsx_table(document))
    with opened(chromium, width) as (_, page):
        witness.watch(page)
        page.goto(f"{site.url}/upload")
        page.set_input_files("#files", own)
        page.get_by_label("Serial number of the unit").fill(f"OWN-{width}")
        page.get_by_label("Measured on").fill("2026-03-01")
        page.get_by_label("Stand: name or number").fill("S1")
        page.get_by_label("Elevation of the head's axis").fill("40")
        page.get_by_label("Latitude").fill("55,81")
        for k in (1, 2, 3):
            page.get_by_label(f"A{k}: scale factor").fill("0.12")
            page.get_by_label(f"A{k}: unit of readings").fill("V")
        page.get_by_label("Axes").select_option("cone")
        page.get_by_role("button", name="Look again").click()
        page.get_by_text("measured 9.8").wait_for()
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        page.get_by_role("button", name="Store it", exact=True).click()
        page.get_by_role("heading", name="Reference set").wait_for()
    assert witness.complaints == []
