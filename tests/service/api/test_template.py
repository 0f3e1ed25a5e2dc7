"""The workbook to fill in: made for a unit type, and taken as it is once it is filled in."""

import fastexcel
import httpx
import pytest

from tests.service.filled import filled

TEMPLATE = "/api/v1/session-template"


def sheet(content: bytes, name: str) -> list[tuple[str, ...]]:
    """The cells as text."""
    frame = fastexcel.read_excel(content).load_sheet(name, header_row=None, dtypes="string").to_polars()
    return [tuple(cell or "" for cell in row) for row in frame.iter_rows()]


def test_a_template_has_the_sensors_stand_and_schedule_of_its_type(flagged: httpx.Client) -> None:
    name = flagged.get("/api/v1/unit-types").json()["unit_types"][0]["name"]
    content = flagged.get(TEMPLATE, params={"unit_type": name}).content
    keys = dict(row[:2] for row in sheet(content, "session"))
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


def test_an_empty_template_says_what_is_missing_in_few_sentences(client: httpx.Client) -> None:
    problems = client.post("/api/v1/sessions", content=client.get(TEMPLATE).content).json()["problems"]
    assert {p["field"] for p in problems} >= {"unit", "stand.id", "A1", "A6"}
    assert len(problems) < 12


def test_a_type_that_is_not_there_has_no_template(client: httpx.Client) -> None:
    assert client.get(TEMPLATE, params={"unit_type": "none"}).status_code == 404
