"""Papers and workbooks in the language of the one who asks."""

from io import BytesIO

import fastexcel
import httpx
import pytest
from pypdf import PdfReader

from service.languages.documents import document_in
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.languages.test_pages import RU, SESSION, UPLOADS, english_in
from tests.service.made_sessions import session_bytes


@pytest.fixture
def judged(holding: Holding) -> httpx.Client:
    """A unit whose second session is out of tolerance, diagnosed."""
    return holding(*UPLOADS, diagnosed=True)


def text_of(answer: httpx.Response) -> str:
    assert answer.headers["content-type"] == "application/pdf"
    assert "Accept-Language" in answer.headers["vary"]
    return " ".join(page.extract_text() for page in PdfReader(BytesIO(answer.content)).pages)


@pytest.mark.parametrize(
    ("address", "said"),
    [
        (f"/api/v1/sessions/{SESSION}/certificate", "Не годен"),
        ("/api/v1/fleet/report?format=pdf", "Отчёт по парку приборов"),
        ("/api/v1/units/BA-017/label.pdf", "напечатано"),
    ],
)
def test_a_paper_in_russian_says_nothing_in_english(judged: httpx.Client, address: str, said: str) -> None:
    text = text_of(judged.get(address, headers=RU))
    assert said in text
    assert english_in([text]) == set()


def test_the_address_chooses_the_language_of_a_paper(judged: httpx.Client) -> None:
    english = judged.get(f"/api/v1/sessions/{SESSION}/certificate")
    assert "Calibration certificate" in text_of(english)
    assert "Сертификат калибровки" in text_of(judged.get(f"/api/v1/sessions/{SESSION}/certificate?lang=ru"))


def test_a_workbook_in_russian(judged: httpx.Client) -> None:
    book = fastexcel.read_excel(judged.get("/api/v1/fleet/report?format=xlsx", headers=RU).content)
    assert book.sheet_names == ["Приборы", "Параметры", "Истории", "О книге"]
    row = book.load_sheet("Приборы").to_polars().rows(named=True)[0]
    assert (row["Прибор"], row["Состояние"]) == ("BA-017", "Не годен")


def test_a_name_is_printed_as_it_was_given_in_every_language(judged: httpx.Client) -> None:
    """`Service` is a word of the catalogue, and `and` one that lists are joined with."""
    for name in ("Service", "Sea and Air Works"):
        judged.put("/api/v1/units/BA-017/customer", json={"name": name, "address": "1 Stand Road"}).raise_for_status()
        text = text_of(judged.get(f"/api/v1/sessions/{SESSION}/certificate", headers=RU))
        assert f"{name}, 1 Stand Road" in text


def test_a_unit_in_a_workbook_keeps_its_name(holding: Holding) -> None:
    client = holding(session_bytes(unit="Stand"))
    book = fastexcel.read_excel(client.get("/api/v1/fleet/report?format=xlsx", headers=RU).content)
    assert book.load_sheet("Приборы").to_polars()["Прибор"].to_list() == ["Stand"]


def test_what_names_something_for_a_template_is_left_alone() -> None:
    document = {"key": "fail", "word": "Unfit", "rows": [{"unit": "Fit", "condition": "Fit"}]}
    assert document_in(document, str.upper) == {
        "key": "fail",
        "word": "UNFIT",
        "rows": [{"unit": "Fit", "condition": "FIT"}],
    }
