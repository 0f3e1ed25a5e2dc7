"""One set of words for verdicts of parameters and one for units; what is fit is a unit; ± is U."""

import re
from functools import cache

import pytest

from service.sessions.words.conditions import CONDITIONS, REFERENCE
from tests.project.source import ROOT, modules

RETIRED = {
    r"beyond doubt": "by more than U",
    r"\b(model|models|simulation) fits?\b": "the model agrees with the readings",
    r"\b[Qq]uality of (the|a) fit\b": "agreement of model and readings",
    r"\b(the|a) fit (is|did|does)\b": "the estimation did",
    r"no part in the fit": "no part in the estimation",
    r"± (is )?one (sigma|standard uncertainty)": "± U, k = 2",
    r"\b(would )?fits? as well\b": "explains as well",
    r"no sensor moved by itself": "nothing: another finding may say that one did",
    r"not the sensors\b": "nothing: another sentence may say that one did",
    r"\b[Ii]n spec\b|\b[Oo]ut of spec\b": "within tolerance, out of tolerance",
}
"""Words that were used once, and what is said instead."""
DOCUMENTS = ("README.md", "docs/glossary.md", "docs/reports.md", "docs/tutorial.md", "docs/diagnosis/index.md")


@cache
def read_by_people() -> dict[str, str]:
    """All text that people read: templates, strings of the service, sentences of the causes, documents."""
    templates = list((ROOT / "service").glob("*/templates/*"))
    found = {path.name: path.read_text("utf-8") for path in templates}
    found |= {name: (ROOT / name).read_text("utf-8") for name in DOCUMENTS}
    for package in ("service", "estimator"):
        for module in modules(package):
            if module.name.startswith(("service.", "estimator.causes")):
                found[module.name] = "\n".join(module.texts)
    return found


@pytest.mark.parametrize("word", RETIRED)
def test_a_retired_word_is_read_nowhere(word: str) -> None:
    again = {place: found[0] for place, text in read_by_people().items() if (found := re.search(word, text))}
    assert again == {}, f"say: {RETIRED[word]}"


def test_the_heading_of_no_section_is_fit() -> None:
    headings = (
        re.findall(r"<h[1-6][^>]*>([^<]*)<|^=+ (.*)$", text, re.MULTILINE) for text in read_by_people().values()
    )
    assert [heading for found in headings for pair in found for heading in pair if heading.strip() == "Fit"] == []


def test_the_glossary_gives_the_one_word_of_every_verdict() -> None:
    glossary = (ROOT / "docs" / "glossary.md").read_text("utf-8")
    for condition in CONDITIONS:
        assert f"| `{condition.key}` | {condition.word} |" in glossary
    assert f"`is_reference` | {REFERENCE.word} |" in glossary
