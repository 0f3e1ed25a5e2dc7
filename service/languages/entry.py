"""A message: one sentence, heading or label as the sources have it, in English, with its places for values."""

import re
from dataclasses import dataclass

from estimator.message import PLACE

LETTERS = re.compile(r"[A-Za-z]{2}")
"""What every message has."""
COUNT = "n"
"""The place whose number decides between one and many."""
TAG = re.compile(r"</?[a-z]\w*>")
"""An inline tag in a message of a page; its attributes are the template's matter."""


@dataclass(frozen=True)
class Entry:
    """What a catalogue has one entry for."""

    text: str
    """As in the source; of a counted thing, what is said of one."""
    many: str = ""
    """What is said of several; empty where nothing is counted."""
    place: str = ""
    """The file that it stands in."""

    @property
    def id(self) -> str | tuple[str, str]:
        """Under which a gettext catalogue knows it."""
        return (self.text, self.many) if self.many else self.text


def places_of(text: str) -> list[str]:
    """The names of a message's places and tags, sorted: a translation has the same."""
    return sorted(PLACE.findall(text) + TAG.findall(text))
