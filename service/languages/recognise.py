"""What was said in English, in another language: a text is recognised as a message of the catalogue, with its values.

A sentence may be one message with values that are messages themselves; it may be several, joined by full stops,
semicolons or commas. Among all readings the one is taken that leaves the fewest words untold, then the one of the
fewest messages. What nobody translated, as a name or a remark that a person wrote, stays as it was written.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from service.languages.grammar import Grammar
from service.languages.message import COUNT, PLACE
from service.languages.pattern import WORD, Pattern, is_closed
from service.languages.reading import ENGLISH, SENTENCES, Reader, Reading, cased

LONGEST = 800
"""Characters of a sentence that is looked at: longer is what somebody wrote."""
REMEMBERED = 20_000
"""Texts whose translation is kept: pages say the same again and again."""


@dataclass(frozen=True)
class Entry:
    """A message and what the catalogue has for it: one form, or one for every plural."""

    texts: tuple[str, ...]
    """As English has it: of one, or of one and of many."""
    forms: tuple[str, ...]


class Recogniser:
    """The messages of one language, found in texts."""

    def __init__(self, entries: Iterable[Entry], grammar: Grammar) -> None:
        self._grammar = grammar
        self._exact: dict[str, str] = {}
        self._patterns: dict[str, list[Pattern]] = defaultdict(list)
        for entry in entries:
            for text in entry.texts:
                pattern = Pattern(text, entry.forms)
                if PLACE.search(text) or not text[0].isalnum() or text.endswith(" ") or pattern.is_fragment:
                    self._patterns[pattern.key].append(pattern)
                self._exact[text] = entry.forms[0]
        self.say = lru_cache(REMEMBERED)(self._say)
        self.settled: dict[str, Reading] = {}
        """Parts of texts that were read beyond doubt."""

    def _say(self, text: str) -> str:
        if text in self._exact:
            return self._exact[text]
        bare = text.strip()
        if not ENGLISH.search(bare):
            return text
        if len(bare) > LONGEST:
            parts = SENTENCES.split(text)
            return " ".join(map(self.say, parts)) if len(parts) > 1 else text
        start = text.index(bare)
        return text[:start] + Reader(self, {}).read(bare).said + text[start + len(bare) :]

    def settle(self, text: str, reading: Reading) -> None:
        """Keeps a reading beyond doubt."""
        if len(self.settled) < REMEMBERED:
            self.settled[text] = reading

    def exact(self, text: str) -> str:
        """The message that a text is, or the same with another first letter, or a day; empty where it is none."""
        if text in self._exact:
            return self._exact[text]
        if date := self._grammar.date(text):
            return date
        turned = text[0].swapcase() + text[1:]
        return cased(self._exact[turned], text) if turned in self._exact else ""

    def candidates(self, text: str) -> Iterator[tuple[Pattern, dict[str, str]]]:
        """Every message with places that the text may be made from, with what stands in them."""
        words = set(WORD.findall(text))
        if first := WORD.match(text):
            words.add(first.group()[0].swapcase() + first.group()[1:])
        for key in (*words, ""):
            for pattern in self._patterns.get(key, ()):
                values = pattern.values(text) if pattern.words <= words else None
                if values is not None and (all(map(is_closed, values.values())) or not is_closed(text)):
                    yield pattern, values

    def form(self, pattern: Pattern, values: Mapping[str, str]) -> str:
        """The translation, in the plural of its number."""
        counts = COUNT in values and len(pattern.forms) > 1
        return pattern.forms[self._grammar.plural(int(values[COUNT]))] if counts else pattern.forms[0]

    def joint(self, english: str) -> str:
        """How two parts are joined."""
        return self._grammar.joints.get(english, english)
