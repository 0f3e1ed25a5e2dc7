"""The label of a unit."""

import io
from dataclasses import fields, replace
from datetime import UTC, datetime
from urllib.parse import quote

import httpx
import pytest
import segno
from pypdf import PdfReader

from service.fleet.condition import UnitSummary
from service.judging.records import Usable, UseFacts
from service.judging.usable import usable
from service.kit.measures import HARD
from service.papers.label import label_of, label_pdf
from service.sessions.decision import Verdict
from tests.conftest import Holding, SettingsHolding
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.service.pages.records import unit_summary
from tests.service.papers.documents import text_of
from tests.service.papers.laboratory import named

SERIAL = "BA/017 Ё?"
UNIT = session_bytes(unit=SERIAL)
BASE, NOW = "https://imu.example.org/", datetime(2026, 11, 21, 12, tzinfo=UTC)
PATH = f"/api/v1/units/{quote(SERIAL, safe='')}/label"


def label(client: httpx.Client, form: str, **query: str) -> httpx.Response:
    """The label of the unit."""
    return client.get(f"{PATH}.{form}", params=query)


def unit_of(client: httpx.Client) -> UnitSummary:
    """The unit in short."""
    [found] = client.get("/api/v1/units").json()["units"]
    own = {field.name: found[field.name] for field in fields(UnitSummary) if field.name in found}
    dates = {name: datetime.fromisoformat(found[name]) for name in ("due", "last_at")}
    return UnitSummary(**own | dates | {"verdict": Verdict(found["verdict"]), "reservations": ()})


def use_of(unit: UnitSummary) -> Usable:
    """Use of the unit, as far as its summary tells."""
    return usable(UseFacts(unit), NOW)


def test_it_says_serial_and_due_date(holding: Holding) -> None:
    client = holding(UNIT)
    answer = label(client, "pdf")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/pdf")
    text = text_of(answer.content)
    assert SERIAL in text
    assert "Calibration" in text
    assert "Calibration" not in text_of(label(client, "pdf", due="false").content)


@pytest.mark.parametrize(
    ("due", "words"),
    [(datetime(2027, 2, 28, tzinfo=UTC), "due 28 Feb 2027"), (datetime(2025, 1, 5, tzinfo=UTC), "since 5 Jan 2025")],
)
@one_engine
def test_the_due_date_is_as_of_today(holding: Holding, due: datetime, words: str) -> None:
    unit = replace(unit_of(holding(UNIT)), due=due)
    assert words in label_of(unit, use_of(unit), BASE, with_due=True).due.replace(HARD, " ")


@one_engine
def test_it_is_one_page_of_sixty_by_thirty_millimetres(holding: Holding) -> None:
    unit = replace(unit_of(holding(UNIT)), serial="N" * 190, unit_type="type " * 40)
    [page] = PdfReader(io.BytesIO(label_pdf(label_of(unit, use_of(unit), BASE, with_due=True), NOW))).pages
    assert [round(float(side) / 72 * 25.4) for side in (page.mediabox.width, page.mediabox.height)] == [60, 30]
    assert "printed 21 Nov 2026" in " ".join(page.extract_text().split())


@one_engine
def test_the_code_leads_to_the_unit_s_page(holding: Holding) -> None:
    client = holding(UNIT)
    unit = unit_of(client)
    drawn = label_of(unit, use_of(unit), BASE, with_due=True)
    squares = segno.make_qr(drawn.address, error="l").svg_inline(border=4, omitsize=True)
    assert drawn.address == f"https://imu.example.org/units/{quote(SERIAL)}"
    assert drawn.code == squares
    assert SERIAL in client.get(drawn.address.removeprefix("https://imu.example.org")).raise_for_status().text


@one_engine
def test_without_a_public_address_it_is_that_of_the_request(settings_holding: SettingsHolding) -> None:
    settings = settings_holding(UNIT)
    codes = {}
    for address in ("", "https://a.example.org", "https://b.example.org/"):
        with named(settings, public_url=address) as client:
            drawn = label(client, "svg")
            codes[address] = drawn.content
    assert drawn.headers["content-type"].startswith("image/svg+xml")
    assert all(code.startswith(b"<svg") for code in codes.values())
    assert len(set(codes.values())) == 3


def test_an_unknown_unit_has_none(client: httpx.Client) -> None:
    assert label(client, "svg").status_code == 404


@pytest.mark.parametrize(
    ("changes", "use", "due"),
    [
        ({}, "", "Calibration due 28 Feb 2027"),
        ({"verdict": Verdict.CONDITIONAL_PASS}, "May be used with reservation", "Calibration due 28 Feb 2027"),
        ({"verdict": Verdict.FAIL}, "Do not use", ""),
        ({"verdict": Verdict.PASS, "due": None}, "Do not use", ""),
        ({"due": datetime(2025, 1, 5, tzinfo=UTC)}, "Do not use", "Calibration overdue since 5 Jan 2025"),
        ({"due": None, "is_undated": True}, "Do not use yet", ""),
    ],
)
def test_what_may_not_be_used_says_so_in_place_of_a_date(changes: dict[str, object], use: str, due: str) -> None:
    unit = replace(unit_summary(), **{"due": datetime(2027, 2, 28, tzinfo=UTC), **changes})
    drawn = label_of(unit, use_of(unit), BASE, with_due=True)
    assert (drawn.use, drawn.due.replace(HARD, " ")) == (use, due)
    printed = " ".join(text_of(label_pdf(drawn, NOW)).split())
    assert (use.upper() if use.startswith("Do") else use) in printed
