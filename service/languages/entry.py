"""A message: one sentence, heading or label in the sources, in English, with its placeholders."""

import re
from dataclasses import dataclass

from estimator.message import PLACE

LETTERS = re.compile(r"[A-Za-z]{2}")
"""Pattern that every message contains."""
COUNT = "n"
"""The placeholder whose number decides between singular and plural."""
TAG = re.compile(r"</?[a-z]\w*>")
"""An inline tag in a message of a page, without its attributes."""


@dataclass(frozen=True)
class MessageEntry:
    """An entry of a catalogue."""

    text: str
    """Text as in the source; the singular of a counted thing."""
    many: str = ""
    """The plural; empty where nothing is counted."""
    place: str = ""

    @property
    def id(self) -> str | tuple[str, str]:
        """Id of the entry in a gettext catalogue."""
        return (self.text, self.many) if self.many else self.text


def places_of(text: str) -> list[str]:
    """The names of a message's placeholders and tags, sorted: a translation has the same."""
    return sorted(PLACE.findall(text) + TAG.findall(text))
