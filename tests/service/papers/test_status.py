"""One page of a unit's present result, to hand over with it."""

from datetime import UTC, datetime
from io import BytesIO

import httpx
import pytest
from pypdf import PdfReader

from service.judging.usable_reading import usable_unit
from service.papers.status import MOST_PARAMETERS, status_paper, status_pdf
from service.records.register import Entering, enter
from service.storage import Storage
from service.units.records import NewEntry
from tests.conftest import Filled, Holding
from tests.databases import one_engine
from tests.service.dated import upload_and_date
from tests.service.made_sessions import FAILED
from tests.service.papers.documents import text_of

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def two_units(storage: Storage) -> None:
    """BA-017 is unfit; BA-900 was never measured, and has long names."""
    for content in FAILED:
        upload_and_date(storage, content, "a.json", NOW)
    long = NewEntry("BA-900", "new type", "Owner " * 30, "Location " * 20, "Custodian " * 18)
    enter(storage, (NewEntry("BA-017", None, "Aero Works", "Hangar 2", "M. Sato"), long), Entering("K. Ito", NOW))


@pytest.fixture
def storage(filled: Filled) -> Storage:
    """Both."""
    return filled(two_units)


@one_engine
def test_it_says_what_the_unit_may_be_used_for_and_what_is_worst(storage: Storage) -> None:
    with storage.database.reading() as store:
        paper, use = status_paper(store, "BA-017", NOW), usable_unit(store, "BA-017", NOW)
    assert paper.why == use.why
    assert (paper.key, paper.condition.key) == ("fail", "fail")
    assert {"Aero Works", "Hangar 2", "M. Sato"} <= {fact.value for fact in paper.facts}
    assert len(paper.rows) == MOST_PARAMETERS < paper.of
    assert paper.rows[0].change.name == "A3 bias"
    assert paper.rows[0].change.condition.key == "fail"


@one_engine
@pytest.mark.parametrize("serial", ["BA-017", "BA-900"])
def test_it_is_one_page(storage: Storage, serial: str) -> None:
    with storage.database.reading() as store:
        content = status_pdf(status_paper(store, serial, NOW), NOW)
    assert len(PdfReader(BytesIO(content)).pages) == 1
    text = text_of(content)
    assert serial in text
    assert "Handed over: name, signature, date" in text


@one_engine
def test_it_is_handed_out_in_the_language_of_the_requester(holding: Holding) -> None:
    http: httpx.Client = holding(*FAILED)
    answer = http.get("/api/v1/units/BA-017/status.pdf", headers={"Accept-Language": "ru"})
    assert answer.headers["content-type"] == "application/pdf"
    assert "Состояние калибровки" in text_of(answer.content)
    assert http.get("/api/v1/units/BA-999/status.pdf").status_code == 404
    assert "status.pdf" in http.get("/units/BA-017").text


@one_engine
def test_a_reference_is_judged_against_nothing(holding: Holding) -> None:
    text = text_of(holding(FAILED[0]).get("/api/v1/units/BA-017/status.pdf").content)
    assert "Reference set" in text
    assert "Undecided" not in text
