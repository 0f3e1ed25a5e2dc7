"""Markup and script in every name, note and file name that somebody can send: a browser shows it and runs nothing."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from urllib.parse import quote

import httpx
import pytest
from playwright.sync_api import Browser
from pypdf import PdfReader

from service.settings import Settings
from tests.builders import Document, accelerometer_block
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook
from tests.end_to_end.browser.conftest import Witness, draw_all, open_all, opened
from tests.serving import serving

pytestmark = pytest.mark.browser

SCRIPT = "<img src=x onerror=window.hit=1>"
"""Run wherever it is taken for markup."""
TEMPLATE = "{{7*191}}${7*191}"
"""Becomes 1337 wherever it is taken for a template."""
STAND, TYPE = f"stand {SCRIPT}", f"type {SCRIPT}"


BREAK = "\u200b"
"""Zero-width space, at which a long word may be broken."""


@dataclass(frozen=True)
class Planted:
    """Addresses that show hostile names."""

    url: str
    paths: tuple[str, ...]
    papers: tuple[str, ...]


def hostile(unit: str, started: str) -> Document:
    """A session whose every free text is markup; its file's, too."""
    document = accelerometer_block(3, positions=12)
    names = {sensor["name"]: f"{SCRIPT}{k}" for k, sensor in enumerate(document["sensors"])}
    table = {rename(column, names): cells for column, cells in document["table"].items()}
    return document | {
        "unit": unit,
        "unit_type": TYPE,
        "operator": f"{SCRIPT} {TEMPLATE}",
        "notes": f"</script><script>window.hit=1</script>{SCRIPT}",
        "started_at": started,
        "stand": document["stand"] | {"id": STAND},
        "sensors": [sensor | {"name": names[sensor["name"]]} for sensor in document["sensors"]],
        "table": table,
    }


def rename(column: str, names: dict[str, str]) -> str:
    """A column of readings or of standard errors under the sensor's new name."""
    own = column.removesuffix("_se")
    return names.get(own, own) + column[len(own) :]


UNIT = f"U {SCRIPT} {TEMPLATE}"


@pytest.fixture
def planted(settings: Settings) -> Iterator[Planted]:
    """A service that holds nothing but hostile names."""
    with serving(settings) as url, httpx.Client(base_url=url) as client:
        ids = []
        for month in (1, 3, 5):
            content = json.dumps(hostile(UNIT, f"2026-0{month}-01T09:00:00Z"))
            answer = client.post("/api/v1/sessions", files={"file": (f"{SCRIPT}.json", content)})
            assert answer.status_code == 201, answer.text
            ids.append(answer.json()["id"])
        serial = quote(UNIT, safe="")
        for what, said in (
            ("notes", {"by": SCRIPT, "text": f"{SCRIPT} {TEMPLATE}"}),
            ("services", {"by": SCRIPT, "note": SCRIPT, "at": "2026-04-01T09:00:00Z", "kind": "service"}),
        ):
            answer = client.post(f"/api/v1/units/{serial}/{what}", json=said)
            assert answer.status_code < 300, answer.text
        lists = ("/", "/flags", "/stands", "/unit-types", "/audit")
        own = [quote(name, safe="") for name in (STAND, TYPE)]
        pages = (*lists, f"/units/{serial}", f"/stands/{own[0]}", f"/unit-types/{own[1]}")
        sessions = [f"/sessions/{id}{page}" for id in ids for page in ("", "/diagnosis")]
        papers = (f"/api/v1/sessions/{ids[0]}/certificate", f"/api/v1/units/{serial}/label.pdf")
        yield Planted(url, (*pages, *sessions), papers)


def test_a_browser_runs_nothing_that_a_name_says(chromium: Browser, planted: Planted) -> None:
    witness, ran = Witness(), []
    with opened(chromium) as (_, page):
        witness.watch(page)
        for path in planted.paths:
            answer = page.goto(planted.url + path)
            assert answer is not None
            assert answer.status == 200, path
            open_all(page)
            draw_all(page)
            for mark in page.locator(".chart .mark-symbol path, .chart .mark-rect path").all()[:20]:
                mark.dispatch_event("mousemove")
            ran += [path] if page.evaluate("window.hit") or page.locator("img[src=x]").count() else []
            assert "1337" not in page.inner_text("body"), path
    assert (ran, witness.complaints) == ([], [])


def test_the_tip_of_a_mark_shows_a_name_as_text(chromium: Browser, planted: Planted) -> None:
    with opened(chromium) as (_, page):
        page.goto(planted.url + planted.paths[5])
        open_all(page)
        draw_all(page)
        tips = set()
        marks = page.locator(".chart [aria-roledescription='point'], .chart .mark-symbol path").all()
        for mark in [mark for mark in marks if mark.is_visible()][:40]:
            mark.evaluate("mark => mark.scrollIntoView({block: 'center'})")
            if (box := mark.bounding_box()) is None:  # drawn anew meanwhile
                continue
            page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            tips |= set(page.locator("#vg-tooltip-element").all_inner_texts())
        assert page.evaluate("window.hit") is None
    assert any("<img" in tip for tip in tips), tips


def test_a_paper_prints_a_name_as_it_is(planted: Planted) -> None:
    for path in planted.papers:
        answer = httpx.get(planted.url + path)
        assert answer.status_code == 200, path
        reader = PdfReader(BytesIO(answer.content))
        printed = "".join(page.extract_text() for page in reader.pages)
        text = "".join(printed.replace(BREAK, "").split())
        assert "onerror" in text, path
        assert "1337" not in text, path
        assert not any(key in answer.content for key in (b"/JavaScript", b"/Launch", b"/EmbeddedFile")), path
