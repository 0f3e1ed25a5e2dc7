"""The catalogue of a language, read once from its gettext file."""

from collections.abc import Iterator, Sequence
from functools import cached_property, lru_cache
from gettext import c2py
from pathlib import Path
from typing import Any

from babel.messages import Catalog
from babel.messages import Message as Stored
from babel.messages.pofile import read_po

from service.languages.charts import chart_in
from service.languages.grammar import DAYS, JOINTS, MONTHS, NAMES_OF_MONTHS, Grammar
from service.languages.language import Language
from service.languages.message import PLACE, Message
from service.languages.recognise import Entry, Recogniser

FOLDER = Path(__file__).parent


class Catalogue:
    """What is said in a language."""

    def __init__(self, language: Language, stored: Catalog) -> None:
        self._stored = stored
        self._grammar = Grammar(
            c2py(stored.plural_expr), JOINTS[language], MONTHS[language], NAMES_OF_MONTHS[language], DAYS[language]
        )
        self.plural = self._grammar.plural

    def forms(self, message: Message) -> Sequence[str]:
        """A message's translation, one text for every plural form; empty where it has none."""
        found = self._stored.get(message.id) or self._stored.get(message.text)
        return forms_of(found) if found else ()

    def say(self, text: str) -> str:
        """A text that was made in English; what is not known stays as it is."""
        return self._recogniser.say(text)

    def chart(self, definition: Any) -> Any:
        """A chart's definition with its words in the language."""
        return chart_in(definition, self.say, self._grammar.time)

    @cached_property
    def _recogniser(self) -> Recogniser:
        return Recogniser(self._entries(), self._grammar)

    def _entries(self) -> Iterator[Entry]:
        """What is recognised. A page's sentences with places are exchanged in its template, and made nowhere else."""
        for one in self._stored:
            texts = _texts(one.id)
            only_pages = one.locations and all(str(place).endswith(".html") for place, _ in one.locations)
            if texts and forms_of(one) and not (only_pages and PLACE.search(texts[0])):
                yield Entry(texts, forms_of(one))


def forms_of(stored: Stored) -> tuple[str, ...]:
    """The translation, where it is whole."""
    texts = _texts(stored.string)
    return texts if all(texts) else ()


def _texts(text: object) -> tuple[str, ...]:
    """Of one message, or of its forms; none of the head of the file."""
    texts = text if isinstance(text, tuple | list) else (text,)
    return tuple(str(one) for one in texts) if texts != ("",) else ()


def path_of(language: Language) -> Path:
    """The file of a language."""
    return FOLDER / f"{language.value}.po"


@lru_cache
def catalogue_of(language: Language) -> Catalogue:
    """The catalogue of a language that is not English."""
    with path_of(language).open("rb") as file:
        return Catalogue(language, read_po(file, locale=language.value, abort_invalid=True))
