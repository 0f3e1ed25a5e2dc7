"""A sentence made from results stands in one file, so that a fact is said in one way everywhere."""

import pytest

from tests.project.source import ROOT, modules

SENTENCES = {
    "Cannot tell which": "service.diagnosis.words.causes",
    "An effect that no known cause explains": "service.diagnosis.words.findings",
    "An effect common to all sensors": "service.diagnosis.words.findings",
    "stated standard errors": "service.sessions.words.noise",
    "a cause outside the catalogue": "service.diagnosis.words.causes",
    "by chance in": "service.diagnosis.words.findings",
    "a sound model would give this much": "service.sessions.words.readings",
    "cannot be observed without motion": "service.judging.words",
    "with one another as at the calibration": "service.judging.words",
    "beyond the tolerance of": "service.judging.words",
}
"""The module in which each sentence is made."""
EXAMPLES = ("schemas", "api")
"""The description of the API quotes answers."""


@pytest.mark.parametrize("sentence", SENTENCES)
def test_a_sentence_is_made_in_one_place(sentence: str) -> None:
    said = (module for module in modules("service") if not module.name.endswith(EXAMPLES))
    places = {module.name for module in said for text in module.texts if sentence in text}
    assert places == {SENTENCES[sentence]}


def test_words_hold_no_markup() -> None:
    words = (module for module in modules("service") if ".words" in module.name)
    assert [text for module in words for text in module.texts if "</" in text or "<p" in text] == []


def test_templates_hold_none_of_these_sentences() -> None:
    templates = [path.read_text("utf-8") for path in (ROOT / "service").glob("*/templates/*.html")]
    assert [sentence for sentence in SENTENCES for text in templates if sentence in text] == []
