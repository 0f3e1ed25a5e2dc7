"""The catalogue of a language, read once from its gettext file."""

import re
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import lru_cache
from gettext import c2py
from pathlib import Path
from typing import Any, TypeVar

from babel.messages import Catalog
from babel.messages import Message as Stored
from babel.messages.pofile import read_po

from estimator.message import Message, filled
from service.languages.charts import LOCALE, chart_in
from service.languages.language import Language

T = TypeVar("T")
SENTENCES = frozenset(
    (
        *("why", "action", "reason", "reasons", "reservations", "summary", "proposal", "text", "advice", "said"),
        *("condition", "due_reason", "use", "what", "before", "after"),
    )
)
"""Fields of records that are said to people."""
FOLDER = Path(__file__).parent
NAMED = frozenset(("unit", "serial", "subject", "stand", "operator", "login", "account", "customer", "filename", "who"))
"""Parts that are names given by people: a unit may be named like one of our words."""


class Catalogue:
    """Translations into one language."""

    def __init__(self, language: Language, stored: Catalog) -> None:
        self._known = {texts[0]: forms_of(m) for m in stored if (texts := _texts(m.id)) and forms_of(m)}
        self._locale = LOCALE[language]
        self._plural = c2py(stored.plural_expr)

    def form(self, english: str, number: int | None = None) -> str:
        """The translation of a whole text or template; of a counted thing, the form for its number."""
        forms = self._forms(english)
        return forms[self._plural(number)] if number is not None and len(forms) > 1 else forms[0]

    def say(self, text: str) -> str:
        """The translation of an English text; unchanged where there is none."""
        if not isinstance(text, Message):
            return self.form(text)
        form = self.form(text.template, text.number)
        return filled(form, {name: part if name in NAMED else self.say(part) for name, part in text.parts.items()})

    def chart(self, definition: Any) -> Any:
        """A chart's definition with translated texts."""
        return chart_in(definition, self.say, self._locale)

    def _forms(self, english: str) -> Sequence[str]:
        """The translated forms of a whole text or template, also with another first letter or without its full stop."""
        if known := self._known.get(english):
            return known
        other_case = english[:1].swapcase() + english[1:]
        if known := self._known.get(other_case):
            change = str.upper if english[0].isupper() else str.lower
            return [change(form[:1]) + form[1:] for form in known]
        if not english.endswith(".") and (f"{english}." in self._known or f"{other_case}." in self._known):
            return [form.removesuffix(".") for form in self._forms(f"{english}.")]
        return [value_in(english, self.say)]


def said_in(record: T, language: Language) -> T:
    """A frozen record with its sentences in a language."""
    if language is Language.ENGLISH:
        return record
    say = catalogue_of(language).say

    def said(name: str, value: Any) -> Any:
        if isinstance(value, tuple):
            return tuple(said(name, item) for item in value)
        if is_dataclass(value):
            return said_in(value, language)
        return say(value) if isinstance(value, str) and name in SENTENCES else value

    return replace(record, **{f.name: said(f.name, getattr(record, f.name)) for f in fields(record) if f.init})  # type: ignore[type-var, arg-type]  # all are dataclasses


def forms_of(stored: Stored) -> tuple[str, ...]:
    """The translation, where it is complete."""
    texts = _texts(stored.string)
    return texts if all(texts) else ()


def _texts(text: object) -> tuple[str, ...]:
    texts = text if isinstance(text, tuple | list) else (text,)
    return tuple(str(form) for form in texts) if texts != ("",) else ()


def path_of(language: Language) -> Path:
    """The file of a language."""
    return FOLDER / f"{language.value}.po"


@lru_cache
def catalogue_of(language: Language) -> Catalogue:
    """The catalogue of a language that is not English."""
    with path_of(language).open("rb") as file:
        return Catalogue(language, read_po(file, locale=language.value, abort_invalid=True))


_NUMBER = r"\d+(?:,\d{3})*(?:\.\d+)?"
VALUE = re.compile(rf"([+−±]?{_NUMBER}(?:(?:\s±\s|–|…){_NUMBER})?)(\s?)([^\s\d.,:;]*)(\s*)")
"""A text that is one number, or a range, and at most one measure."""
NARROW = "\u202f"
"""Space between thousands."""


def value_in(text: str, say: Callable[[str], str]) -> str:
    """A number with its measure; any other text as it is."""
    found = VALUE.fullmatch(text)
    if found is None:
        return text
    number, gap, label, rest = found.groups()
    measure = "/".join(map(say, label.split("/")))
    return f"{number.replace(',', NARROW).replace('.', ',')}{gap}{measure}{rest}"
