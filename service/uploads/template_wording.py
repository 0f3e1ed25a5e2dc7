"""In which words a workbook to fill in speaks: those of session files, or their Russian ones that readers know too."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from service.ingest.in_russian import SHEETS, heading_in_russian, key_in_russian, value_in_russian
from service.languages.catalogue import catalogue_of
from service.languages.language import Language


@dataclass(frozen=True)
class Wording:
    """How each part of the workbook is called."""

    sheet: Callable[[str], str]
    key: Callable[[str], str]
    heading: Callable[[str], str]
    value: Callable[[str, Any], Any]
    """Of a key or a column, by its English name."""
    say: Callable[[str], str]
    """A hint or a warning."""


def wording(language: Language, sensors: Sequence[str]) -> Wording:
    """The words of a language."""
    if language is Language.ENGLISH:
        return Wording(_as_it_is, _as_it_is, _as_it_is, lambda _, value: value, _as_it_is)
    return Wording(
        sheet=lambda name: SHEETS[name],
        key=key_in_russian,
        heading=lambda name: heading_in_russian(name, sensors),
        value=value_in_russian,
        say=catalogue_of(language).say,
    )


def _as_it_is(text: str) -> str:
    return text
