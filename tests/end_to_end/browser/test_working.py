"""A list is worked through: by keys, flags given to somebody."""

import pytest
from playwright.sync_api import Browser, Page

from tests.end_to_end.browser.conftest import Site, Witness, follow, open_all, opened

pytestmark = pytest.mark.browser


def focused(page: Page) -> str:
    return str(page.evaluate("document.activeElement.textContent"))


def test_rows_are_walked_and_opened_by_keys(chromium: Browser, site: Site) -> None:
    witness = Witness()
    with opened(chromium) as (_, page):
        witness.watch(page)
        page.goto(site.url)
        units = page.locator("table.units tbody th a:not(.tag)").all_inner_texts()
        for keys, expected in (("j", units[0]), ("j", units[1]), ("k", units[0])):
            page.keyboard.press(keys)
            assert focused(page) == expected
        page.keyboard.press("Enter")
        page.wait_for_url("**/units/*")
        page.keyboard.press("?")
        page.wait_for_url("**/help#keys")
    assert witness.complaints == []


def test_keys_are_letters_where_somebody_writes(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(site.url)
        page.keyboard.press("/")
        page.keyboard.type("j?k/")
        assert page.locator("#q").input_value() == "j?k/"
        assert page.locator("tr.at").count() == 0
        page.locator("#q").blur()
        page.keyboard.press("Control+j")
        assert page.locator("tr.at").count() == 0


def test_keys_can_be_switched_off(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(f"{site.url}/help")
        open_all(page)
        page.get_by_label("Keys are switched on").uncheck()
        page.goto(site.url)
        page.keyboard.press("j")
        assert page.locator("tr.at").count() == 0


def test_a_session_gets_a_remark_and_a_file(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(f"{site.url}/sessions/{site.first_session}")
        page.get_by_text("Write a remark").click()
        form = page.locator("#remarks details[open]")
        form.locator("[name=text]").fill("the room was warm")
        form.locator("[name=by]").fill("K. Ito")
        follow(form.get_by_role("button"))
        page.get_by_text("Attach a file").click()
        form = page.locator("#remarks details[open]")
        form.locator("[name=file]").set_input_files({"name": "a.html", "mimeType": "text/html", "buffer": b"<b>"})
        form.locator("[name=by]").fill("K. Ito")
        follow(form.get_by_role("button", name="Attach"))
        assert "the room was warm" in page.locator("#remarks").inner_text()
        with page.expect_download() as saved:
            page.get_by_role("link", name="a.html").click()
        assert saved.value.path().read_bytes() == b"<b>"


def test_flags_are_ticked_by_keys_and_given_to_somebody(chromium: Browser, site: Site) -> None:
    with opened(chromium) as (_, page):
        page.goto(f"{site.url}/flags?q=BA-017")
        for key in "jx":
            assert not page.locator("#chosen").is_visible()
            page.keyboard.press(key)
        form = page.locator("#chosen")
        for name, value in {"by": "K. Ito", "why": "knows the unit", "to": "M. Sato"}.items():
            form.locator(f"[name={name}]").fill(value)
        follow(form.get_by_role("button", name="Assign"))
        assert page.url.endswith("/flags?q=BA-017")
        assert "M. Sato" in page.locator(".flag h2").first.inner_text()
