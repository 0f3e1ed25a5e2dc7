"""The workbook to fill in: made for a unit type, and taken as it is once it is filled in."""

import fastexcel
import httpx
import pytest

from tests.service.filled import filled
from tests.service.made_sessions import session_bytes

TEMPLATE = "/api/v1/session-template"
SQLITE = pytest.mark.parametrize("databases", ["sqlite"], indirect=True)
"""Runs on one engine, where no database decides."""
RUSSIAN = ["сеанс", "показания", "пример"]


def sheet(content: bytes, name: str) -> list[tuple[str, ...]]:
    """The cells as text."""
    frame = fastexcel.read_excel(content).load_sheet(name, header_row=None, dtypes="string").to_polars()
    return [tuple(cell or "" for cell in row) for row in frame.iter_rows()]


def test_a_template_has_the_sensors_stand_and_schedule_of_its_type(flagged: httpx.Client) -> None:
    name = flagged.get("/api/v1/unit-types").json()["unit_types"][0]["name"]
    content = flagged.get(TEMPLATE, params={"unit_type": name}).content
    keys = {row[0]: row[1] for row in sheet(content, "session")}
    readings = sheet(content, "readings")
    assert (keys["sensors[1].name"], keys["stand.id"], keys["unit"]) == ("A1", "ODG-1", "")
    assert readings[0][:2] == ("run", "beta_deg")
    assert readings[1][:2] == ("direct", "0")


def test_a_template_states_nothing_that_is_to_be_measured(flagged: httpx.Client) -> None:
    readings = sheet(flagged.get(TEMPLATE, params={"unit": "BA-017"}).content, "readings")
    measured = [k for k, name in enumerate(readings[0]) if name not in ("run", "beta_deg")]
    assert not any(row[k] for row in readings[1:] for k in measured)


@pytest.mark.parametrize("query", [{}, {"kind": "gyroscope", "sensors": "3"}])
def test_a_filled_template_is_a_session(client: httpx.Client, query: dict[str, str]) -> None:
    content = filled(client.get(TEMPLATE, params=query).content, {"unit": "MY-1", "stand.id": "S1"})
    answer = client.post("/api/v1/sessions", content=content)
    assert answer.status_code == 201, answer.text
    assert answer.json()["unit"] == "MY-1"


@SQLITE
@pytest.mark.parametrize("query", [{}, {"kind": "gyroscope"}])
def test_a_template_in_russian_comes_back_as_the_same_session(client: httpx.Client, query: dict[str, str]) -> None:
    english = client.get(TEMPLATE, params=query)
    russian = client.get(TEMPLATE, params=query, headers={"Accept-Language": "ru"})
    assert (russian.headers["content-language"], fastexcel.read_excel(russian.content).sheet_names) == ("ru", RUSSIAN)
    stored = client.post("/api/v1/sessions", content=filled(english.content, {"unit": "MY-1", "stand.id": "S1"}))
    asked = {"прибор": "MY-1", "стенд.номер": "S1"}
    again = client.post("/api/v1/sessions", content=filled(russian.content, asked))
    assert (stored.status_code, again.status_code, again.json()["id"]) == (201, 200, stored.json()["id"])


@SQLITE
def test_a_template_in_russian_says_nothing_in_english(client: httpx.Client) -> None:
    content = client.get(TEMPLATE, params={"lang": "ru"}).content
    names = {"accelerometer", "gyroscope", "as-found", "as-left"}
    said = " ".join(text for name in RUSSIAN for row in sheet(content, name) for text in row)
    assert not names & set(said.replace("(", " ").split())
    assert {"акселерометр", "двухосный", "прямая", "обратная"} <= set(said.split())


@SQLITE
def test_a_fault_in_a_russian_template_is_told_by_its_cell(client: httpx.Client) -> None:
    asked = {"прибор": "MY-1", "стенд.номер": "S1", "программа": "весы"}
    content = filled(client.get(TEMPLATE, params={"lang": "ru"}).content, asked)
    problems = client.post("/api/v1/sessions", content=content).json()["problems"]
    assert [(p["field"], "of the sheet сеанс" in p["message"]) for p in problems] == [("programme", True)]


def test_an_empty_template_says_what_is_missing_in_few_sentences(client: httpx.Client) -> None:
    problems = client.post("/api/v1/sessions", content=client.get(TEMPLATE).content).json()["problems"]
    assert {p["field"] for p in problems} >= {"unit", "stand.id", "A1", "A6"}
    assert len(problems) < 12


def test_a_type_that_is_not_there_has_no_template(client: httpx.Client) -> None:
    assert client.get(TEMPLATE, params={"unit_type": "none"}).status_code == 404


@SQLITE
def test_a_template_made_after_a_simulated_session_is_for_a_measured_one(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes(origin="simulated")).raise_for_status()
    rows = sheet(client.get(TEMPLATE, params={"unit": "BA-017"}).content, "session")
    assert "origin" not in {row[0] for row in rows}


@SQLITE
@pytest.mark.parametrize(("lang", "unit", "origin"), [
    ("en", "unit", {"origin": "simulated"}), ("ru", "прибор", {"происхождение": "имитация"}),
])  # fmt: skip
def test_a_template_filled_in_for_a_simulated_unit_must_say_that_it_is_simulated(
    client: httpx.Client, lang: str, unit: str, origin: dict[str, str]
) -> None:
    client.post("/api/v1/sessions", content=session_bytes(origin="simulated")).raise_for_status()
    empty = client.get(TEMPLATE, params={"unit": "BA-017", "lang": lang}).content
    asked = {unit: "BA-017"}
    silent, said = (client.post("/api/v1/sessions", content=filled(empty, asked | more)) for more in ({}, origin))
    assert [problem["field"] for problem in silent.json()["problems"]] == ["origin"]
    assert (said.status_code, client.get(said.json()["url"]).json()["simulated"]) == (201, True)
