"""A verdict is never said without its reservation: on pages, papers, in tables and programs' answers alike."""

import io
from xml.etree import ElementTree

import httpx
import polars as pl
import pytest

from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.doubtful import CLAUSE, JUMPED, SLIGHTLY
from tests.service.made_sessions import session_id
from tests.service.pages.test_http import HTML
from tests.service.papers.documents import text_of

ID = session_id(JUMPED[-1])
API = "/api/v1"


@pytest.fixture
def jumped(holding: Holding) -> httpx.Client:
    """A fit unit whose A2 jumped by as much as is allowed."""
    return holding(*JUMPED, diagnosed=True)


def said(client: httpx.Client) -> str:
    """The verdict as the session's own answer words it."""
    answer: str = client.get(f"{API}/sessions/{ID}").json()["said"]
    assert answer.startswith(f"Fit, but {CLAUSE}")
    assert answer.endswith("tolerance 50\u202fµg): repeat the session")
    return answer


def clause(client: httpx.Client) -> str:
    """The clause after its ``but``."""
    return plain(said(client).partition(", but ")[2])


def plain(text: str) -> str:
    """The text with ordinary spaces, and none that only allow a line to break."""
    return " ".join(text.replace("\u200b", "").split())


@one_engine
@pytest.mark.parametrize("path", ["/", "/units/BA-017", f"/sessions/{ID}"])
def test_pages(jumped: httpx.Client, path: str) -> None:
    shown = jumped.get(path, headers=HTML).text
    matter = clause(jumped).removeprefix("but ").partition(":")[0]
    assert matter in plain(shown).replace("The bias", "the bias")
    assert "May be used with reservation" in shown or "#reserved" in shown


@one_engine
def test_the_answer_to_an_upload(jumped: httpx.Client) -> None:
    files = {"files": ("again.json", JUMPED[-1])}
    shown = jumped.post("/upload", files=files, headers={"sec-fetch-site": "same-origin", **HTML}).text
    assert clause(jumped) in plain(shown)


@one_engine
@pytest.mark.parametrize("path", [f"{API}/sessions/{ID}/certificate", f"{API}/fleet/report?format=pdf"])
def test_papers(jumped: httpx.Client, path: str) -> None:
    assert clause(jumped) in plain(text_of(jumped.get(path).content))


@one_engine
def test_the_digital_certificate(jumped: httpx.Client) -> None:
    tree = ElementTree.fromstring(jumped.get(f"{API}/sessions/{ID}/certificate?format=dcc").content)
    assert any((element.text or "").startswith(plain(said(jumped))) for element in tree.iter())


@one_engine
def test_tables(jumped: httpx.Client) -> None:
    book = pl.read_excel(io.BytesIO(jumped.get(f"{API}/fleet/report?format=xlsx").content), sheet_name="Fleet")
    assert book["Verdict in words"].to_list() == [said(jumped)]
    assert book["Condition"].to_list() == ["Fit, with reservation"]
    lines = pl.read_csv(jumped.get(f"{API}/fleet/report?format=csv").content)
    assert lines["said"].to_list() == [said(jumped)]


def test_answers_to_programs(jumped: httpx.Client) -> None:
    unit = jumped.get(f"{API}/units/BA-017").json()
    answers = (
        jumped.post(f"{API}/sessions", content=JUMPED[-1]).json(),
        jumped.get(f"{API}/sessions/{ID}").json(),
        unit["summary"],
        unit["sessions"][0],
        jumped.get(f"{API}/units").json()["units"][0],
    )
    for answer in answers:
        assert (answer["verdict"], answer["said"]) == ("pass", said(jumped))
        assert [one["cause"] for one in answer["reservations"]] == ["bias-jump"]


def test_units_with_a_reservation_are_counted_and_found(jumped: httpx.Client) -> None:
    assert jumped.get(f"{API}/fleet").json()["reserved"]["pass"] == 1
    found = [len(jumped.get(f"{API}/units?reserved={wanted}").json()["units"]) for wanted in ("true", "false")]
    assert found == [1, 0]
    assert "BA-017" in jumped.get("/?use=no", headers=HTML).text


@one_engine
def test_a_plain_verdict_is_said_plainly(holding: Holding) -> None:
    client = holding(*SLIGHTLY, diagnosed=True)
    assert client.get(f"{API}/units/BA-017").json()["summary"]["said"] == "Fit"
    assert client.get(f"{API}/fleet").json()["reserved"]["pass"] == 0
    assert "No unit matches" in client.get("/?use=with-reservation", headers=HTML).text
