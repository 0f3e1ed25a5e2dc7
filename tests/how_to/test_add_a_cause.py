"""docs/how-to/add-a-cause.md, followed: one class and one line, and every room knows the new cause."""

import json

import pytest

from tests.how_to.conftest import Served
from tests.how_to.follow import House, followed, plain

SENTENCE = "The zero of A2 is another one beyond a certain input"


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> House:
    """The source with the page's cause."""
    return followed(tmp_path_factory.mktemp("cause"), "add-a-cause")


@pytest.fixture(scope="module")
def said(house: House) -> list[str]:
    """Output of the page's shell example for each of its three sessions."""
    return house.shell().split("\n\n")


def test_the_hidden_effect_is_named_with_its_size_and_place(said: list[str]) -> None:
    assert SENTENCE in said[0]
    assert "size 102.1 ± 3.9 µg; beyond 493.3 mg" in said[0]


def test_the_cause_may_act_twice_on_one_sensor(said: list[str]) -> None:
    assert "A2: beyond 371.4 mg; A2: beyond 718.5 mg" in said[1]


def test_and_three_times(said: list[str]) -> None:
    assert "A2: beyond 371.4 mg; A2: beyond" in said[2]
    assert said[2].count("A2: beyond") == 3


def test_the_catalogue_page_shows_the_cause(house: House) -> None:
    house.run("python", "-m", "benchmarks.catalogue")
    page = (house.root / "docs" / "diagnosis" / "causes.md").read_text(encoding="utf-8")
    assert "| `range-switch` | k where \\|a\\| > a0, a0 free | m/s² | – | The zero of the sensor is another" in page


@pytest.mark.usefixtures("said")
def test_the_page_of_an_uploaded_session_says_it_in_the_cause_s_words(house: House, served: Served) -> None:
    document = json.loads((house.root / "once.json").read_bytes()) | {"unit": "SWITCHED"}
    id = served.http.post("/api/v1/sessions", content=json.dumps(document)).json()["id"]
    page = plain(served.http.get(f"/sessions/{id}/diagnosis").text)
    assert SENTENCE in page
    assert "Fix the voltmeter" in page
    assert "102.1 ± 3.9 µg" in page
    assert '<input type="hidden" name="cause" value="range-switch">' in page, "it can be accepted into a model"
