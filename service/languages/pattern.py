"""A message with places, as what recognises a text that was made from it."""

import re
from functools import cached_property

from service.languages.message import COUNT, PLACE

WORD = re.compile(r"[A-Za-z]{2,}")
WHOLE_WORD = re.compile(r"(?<![\w\x00])[A-Za-z]{2,}(?![\w\x00])")
HEAD, LEAD, TAIL = "head_", "lead_", "tail_"
"""What stands before a message that goes on with a sentence, how it does so, and what stands after one that is gone on
with."""
LEADS = " ,;.:"
"""How a message begins that goes on with a sentence; where it stands alone, it has lost that."""
ANY = "."
CLOSED = r"(?:\((?:[^()]|\([^()]*\))*\)|[^()])"
"""What a place is made of: anything; or, where a text closes its brackets, whole brackets and what stands outside."""
FEW_LETTERS = 6
"""Of its own words: a message with fewer, as ``by {who}``, fits too much to be believed unless all is told by it."""


class Pattern:
    """One message and its translation, one form for every plural."""

    def __init__(self, text: str, forms: tuple[str, ...]) -> None:
        self.text, self.forms = text, forms
        told = PLACE.sub("\x00", text)
        self.words = frozenset(WHOLE_WORD.findall(told))
        """Whole words that every text made from it has."""
        self.letters = sum(map(len, WORD.findall(told)))

    @property
    def key(self) -> str:
        """The longest of its words, which few others have."""
        return max(self.words, key=len, default="")

    @property
    def is_vague(self) -> bool:
        """Whether its own words say too little to know it by them alone."""
        return self.letters < FEW_LETTERS

    @property
    def is_fragment(self) -> bool:
        """Whether it goes on with a sentence: ``has jumped between {after} and {before}``."""
        return bool(re.match(r"[a-z]+ [a-z{]", self.text))

    def values(self, text: str) -> dict[str, str] | None:
        """What stands in its places; none where the text is not made from it."""
        match = (self._closed if is_closed(text) else self._shape).fullmatch(text)
        if match is None:
            return None
        return {name.removeprefix("p_"): value for name, value in match.groupdict().items() if value}

    @cached_property
    def _shape(self) -> re.Pattern[str]:
        return self._shaped(ANY)

    @cached_property
    def _closed(self) -> re.Pattern[str]:
        return self._shaped(CLOSED)

    def _shaped(self, some: str) -> re.Pattern[str]:
        parts = PLACE.split(self.text)
        first = parts[0].lstrip(LEADS)
        lead = re.escape(parts[0][: len(parts[0]) - len(first)]) or (r"\s" if self.is_fragment else "")
        head = f"(?:(?P<{HEAD}>.*?)(?P<{LEAD}>{lead}))?" if lead else ""
        tail = f"(?P<{TAIL}>.*)" if self.text.endswith(" ") else ""
        places = "".join(
            self._place(parts, k, some) + re.escape(parts[k + 1]) for k in range(1, len(parts), 2)
        )  # text and place by turns
        return re.compile(head + _either_case(first) + places + tail, re.DOTALL)

    @staticmethod
    def _place(parts: list[str], k: int, some: str) -> str:
        """A place: a number where it counts, the same again where it was before, nothing where it is an addition."""
        name = parts[k]
        if name in parts[1:k:2]:
            return f"(?P=p_{name})"
        if name == COUNT:
            return rf"(?P<p_{name}>\d+)"
        is_addition = parts[k - 1][-1:].isalnum() or parts[k - 1].endswith(".")
        return f"(?P<p_{name}>{some}{'*?' if is_addition else '+?'})"


def is_closed(text: str) -> bool:
    """Whether every bracket that it opens is closed in it."""
    return text.count("(") == text.count(")")


def _either_case(literal: str) -> str:
    """The first letter of a sentence depends on what stands before it."""
    return f"(?i:{re.escape(literal[0])}){re.escape(literal[1:])}" if literal[:1].isalpha() else re.escape(literal)
