"""The page of a diagnosis where what was taken for granted is false: causes, stands and noise that nobody listed."""

import json
from html import unescape
from typing import Any

import httpx

from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import DOUBTED, boasting, diagnosis_of, held, swaying_stand
from tests.service.diagnosis.test_diagnosis_page import page
from tests.service.made_sessions import session_id
from tests.service.pages.test_http import HTML

SMALL = "the stated standard errors are about 4 times too small"


def shown(holding: Holding, document: dict[str, Any]) -> tuple[httpx.Client, str, str]:
    """A service that holds a session, its id, and its page."""
    content = json.dumps(document).encode()
    client, id = holding(content), session_id(content)
    return client, id, unescape(page(client, id))


def headline(text: str) -> str:
    """The headline of a page."""
    return text[text.index("<h1>") : text.index("</h1>")]


def test_what_all_sensors_show_sends_people_to_the_stand(holding: Holding) -> None:
    _, _, text = shown(holding, swaying_stand())
    assert "An effect common to all sensors, of the stand or fixture, that no known cause explains" in headline(text)
    assert "Check the stand, the fixture and the reference" in text


def test_the_course_is_drawn_and_stands_in_a_table(holding: Holding) -> None:
    client, id, text = shown(holding, swaying_stand())
    (structure,) = diagnosis_of(client, id)["structures"]
    section = text[text.index("The course of the applied vector") : text.index("Measured minus simulated")]
    assert 'data-spec="spec-course-1-angle"' in section
    table = section[section.index("<table>") : section.index("</table>")]
    assert "α, arcsec" in table
    assert table.count("<tr>") == 1 + len(structure["course"]["values"])


def test_wrong_standard_errors_are_the_first_thing_said_where_nothing_else_is_wrong(holding: Holding) -> None:
    client, id, text = shown(holding, boasting())
    assert f"Nothing wrong found, but {SMALL}" in headline(text)
    assert "correct the standard errors" in text
    assert SMALL in client.get(f"/sessions/{id}").text
    assert [one["kind"] for one in diagnosis_of(client, id)["noise"]] == ["accelerometer"]


def test_a_doubt_of_a_name_stands_beside_it_and_its_advice_waits(holding: Holding) -> None:
    text = unescape(page(*held(holding, DOUBTED)))
    assert "The bias of A2 has one step (95.1\xa0% likely), or a cause outside the catalogue" in text
    assert "If it appears again:" in text
    assert 'value="unexplained"' not in text


def test_gain_has_a_line_for_every_kind_of_sensor(holding: Holding) -> None:
    text = page(*held(holding, DOUBTED))
    assert "error of prediction of accelerometers" in text
    assert "error of prediction of gyroscopes" in text


def test_the_answer_to_an_upload_says_it_too(holding: Holding) -> None:
    file = ("boast.json", json.dumps(boasting()).encode())
    client = holding()
    card = client.post("/upload", files={"files": file}, headers=HTML | {"Origin": str(client.base_url)}).text
    assert "Still being examined" in card
    id = session_id(file[1])
    diagnosis_of(client, id)
    assert SMALL in client.get(f"/sessions/{id}/outcome", headers=HTML).text
