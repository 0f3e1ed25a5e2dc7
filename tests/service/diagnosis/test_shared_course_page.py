"""A board that warms, over HTTP: one finding with its course, in the API, on the page and in Russian."""

import json
from functools import cache

import httpx
import numpy as np

from tests.blind.courses import BLOCKS, draw_course
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import diagnosis_of
from tests.service.made_sessions import session_id
from tests.service.pages.test_http import HTML


@cache
def warming() -> bytes:
    """The file of a session in which all six sensors settle together."""
    hidden = draw_course(BLOCKS[0], "exponential", 6, 40.0, np.random.default_rng((52, 1)), even=True)
    return json.dumps(hidden.session).encode()


def held(holding: Holding) -> tuple[httpx.Client, str]:
    """A service that holds it with its diagnosis, and its id."""
    return holding(warming(), diagnosed=True), session_id(warming())


def page(client: httpx.Client, id: str, language: str) -> str:
    """The session's diagnosis page."""
    answer = client.get(f"/sessions/{id}/diagnosis?lang={language}", headers=HTML)
    assert answer.status_code == 200, answer.text
    return answer.text


def test_the_api_answers_one_finding_with_the_course_of_all_sensors(holding: Holding) -> None:
    [finding] = diagnosis_of(*held(holding))["findings"]
    shared = finding["shared"]
    assert (finding["cause"], len(finding["sensors"]), shared["group"]) == ("warm-up", 6, "all")
    assert shared["shape_sigma"]["s"] < shared["shape"]["s"]
    assert len(shared["course"]) == len(shared["measured"]) == len(shared["band"])


def test_the_page_says_it_in_one_sentence_and_draws_one_chart(holding: Holding) -> None:
    text = page(*held(holding), "en")
    assert "The biases of all sensors of the block settle together after switch-on." in text
    assert "time constant" in text
    assert text.count('id="spec-shared-1"') == 1
    assert "The common course as a table" in text


def test_the_page_says_it_in_russian(holding: Holding) -> None:
    text = page(*held(holding), "ru")
    assert "Смещения нуля всех датчиков блока вместе устанавливаются после включения." in text
    assert "Общий ход" in text
