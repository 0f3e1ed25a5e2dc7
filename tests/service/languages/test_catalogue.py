"""The catalogue says everything that the sources say, and nothing else."""

import re
from functools import cache

import pytest
from babel.messages import Catalog
from babel.messages.pofile import read_po

from service.languages.catalogue import forms_of, path_of
from service.languages.language import Language
from service.languages.update import extracted, untranslated, updated

OTHERS = [language for language in Language if language is not Language.ENGLISH]
WHAT_TO_DO = "run `make words`, then write the translations into service/languages/*.po"


PLACE_OR_TAG = re.compile(r"\{\w+\}|%\(\w+\)s|</?[a-z][^<>]*>")


def places_of(text: str) -> list[str]:
    """The places and tags of a message, sorted: a translation has the same."""
    return sorted(PLACE_OR_TAG.findall(text))


def stored(language: Language) -> Catalog:
    with path_of(language).open("rb") as file:
        return read_po(file, locale=language.value)


@cache
def said(language: Language) -> Catalog:
    """The catalogue as the sources have it now."""
    return updated(language, extracted())


@pytest.mark.parametrize("language", OTHERS)
def test_every_message_is_translated(language: Language) -> None:
    assert untranslated(said(language)) == [], WHAT_TO_DO


@pytest.mark.parametrize("language", OTHERS)
def test_nothing_is_kept_that_is_no_longer_said(language: Language) -> None:
    assert {one.id for one in stored(language)} == {one.id for one in said(language)}, WHAT_TO_DO


@pytest.mark.parametrize("language", OTHERS)
def test_no_translation_is_a_guess(language: Language) -> None:
    catalogue = stored(language)
    assert [one.id for one in catalogue if one.id and one.fuzzy] == []
    assert list(catalogue.obsolete) == []


@pytest.mark.parametrize("language", OTHERS)
def test_a_translation_has_the_places_and_tags_of_its_message(language: Language) -> None:
    wrong = [
        (one.id, form)
        for one in stored(language)
        if one.id
        for form in forms_of(one)
        if places_of(form) != places_of(one.id[1] if isinstance(one.id, tuple) else str(one.id))
    ]
    assert wrong == []


@pytest.mark.parametrize("language", OTHERS)
def test_a_counted_thing_has_every_plural_form(language: Language) -> None:
    catalogue = stored(language)
    counted = [one for one in catalogue if isinstance(one.id, tuple)]
    assert counted
    assert {len(forms_of(one)) for one in counted} == {catalogue.num_plurals}


@pytest.mark.parametrize("language", OTHERS)
def test_a_translation_goes_on_as_its_message_does(language: Language) -> None:
    """A message that ends with a space is followed by something."""
    ends = [(str(one.id), forms_of(one)[0]) for one in stored(language) if isinstance(one.id, str) and one.id]
    assert [pair for pair in ends if pair[0].endswith(" ") != pair[1].endswith(" ")] == []
