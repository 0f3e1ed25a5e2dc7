"""The words of a workbook in Russian: every English one has one, and is found by it again."""

import pytest

from estimator.reading.keys import COLUMNS, SENSOR, SIGMA, SITE, STAND, TOP
from estimator.session import COUNTERS, PROGRAMMES, STAGES
from service.ingest import in_russian


@pytest.mark.parametrize("words", [in_russian.SHEETS, in_russian.STEPS, in_russian.COLUMNS, in_russian.VALUES])
def test_no_two_words_are_the_same_in_russian(words: dict[str, str]) -> None:
    assert len(set(words.values())) == len(words)
    assert not any("." in text or "[" in text for text in words.values())


def test_every_field_column_and_choice_has_a_word() -> None:
    fields = {*TOP, *SITE, *STAND, *SIGMA, *SENSOR} - {"table"}
    assert fields - in_russian.STEPS.keys() == set()
    assert set(COLUMNS) - in_russian.COLUMNS.keys() == set()
    assert {*PROGRAMMES, *STAGES, *COUNTERS} - in_russian.VALUES.keys() == set()


@pytest.mark.parametrize("key", ["unit", "stand.alpha_deg", "stand.sigma_arcsec.beta", "sensors[12].nominal_axis"])
def test_a_key_comes_back_from_russian(key: str) -> None:
    assert in_russian.key_in_russian(key) != key
    assert in_russian.key_in_english(in_russian.key_in_russian(key)) == key


@pytest.mark.parametrize("heading", ["run", "A1_se", "beta_deg", "A1", "my_se"])
def test_a_heading_comes_back_from_russian(heading: str) -> None:
    assert in_russian.heading_in_english(in_russian.heading_in_russian(heading, ["A1"])) == heading
