"""The messages of a page's template, found without markers.

A message is a run of text between block tags and statements, with its inline tags (without attributes) and with a
placeholder for every expression. The author of a page writes plain English, and no text can be forgotten.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from service.languages.entry import MessageEntry
from service.languages.pieces import Piece

INLINE = frozenset(("a", "abbr", "b", "em", "i", "small", "strong", "sub", "sup", "span", "time"))
"""Tags that may stand inside a sentence."""
TEXT_ATTRIBUTES = frozenset(("alt", "aria-label", "data-label", "label", "placeholder", "title"))
SCRIPT_TEXT_PREFIX = "data-said-"
ENGLISH = ' lang="en"'
"""Marks an element that is not translated, such as the description of the API."""
SILENT = re.compile(r"<(script|style|svg)\b.*?</\1>", re.DOTALL)
"""Elements without words."""
CODE = re.compile(r"<code\b.*?</code>", re.DOTALL)
"""Code is the same in every language."""
JINJA = re.compile(r"\{%.*?%\}|\{\{.*?\}\}|\{#.*?#\}", re.DOTALL)
TAG = re.compile(r"<(/?)([a-zA-Z][\w-]*)[^<>]*>|<![^<>]*>")
ATTRIBUTE = re.compile(r'([\w-]+)="([^"]*)"')
LETTERS = re.compile(r"[A-Za-z]{2,}")
PERSONAL_EXPRESSIONS = re.compile(
    r"\b(serial|unit|unit_type|operator|stand|notes?|why|login|filename|lot|customer\.\w+|issued_by|account)\s*\}\}$"
)
"""Ends of expressions for names or texts written by people."""
FIRST = 0xF0000
"""Private characters of Unicode stand for everything that is not HTML while HTML is parsed."""


@dataclass(frozen=True)
class TemplateMessage:
    """A message in a template, between two positions of its flat text."""

    start: int
    end: int
    message: MessageEntry
    piece: Piece


class Template:
    """One source, with everything that is not HTML replaced by one character each."""

    def __init__(self, source: str, name: str = "") -> None:
        self.name, self._parts = name, list[str]()
        flat = JINJA.sub(self._kept, source)
        self.flat = CODE.sub(self._kept, SILENT.sub(self._kept, flat))
        self._tags = list(TAG.finditer(self.flat))

    def _kept(self, match: re.Match[str]) -> str:
        self._parts.append(match.group())
        return chr(FIRST + len(self._parts) - 1)

    def part(self, char: str) -> str:
        """The source behind a character; empty where it stands for itself."""
        return self._parts[ord(char) - FIRST] if ord(char) >= FIRST else ""

    def jinja(self) -> Iterator[tuple[str, bool]]:
        """Every expression and statement, and whether its value is in text for people."""
        for k, char in enumerate(self.flat):
            if self.part(char).startswith(("{{", "{%")):
                yield self.part(char), k in self._spoken

    def whole(self, flat: str) -> str:
        """The source of a flat text."""
        return "".join(self.whole(self.part(c)) if ord(c) >= FIRST else c for c in flat)

    def spoken_source(self, start: int, end: int) -> str:
        """The source between two positions, with expressions for people translated."""
        return "".join(
            translating(self.part(c)) if k in self._spoken and self.part(c).startswith("{{") else self.whole(c)
            for k, c in enumerate(self.flat[start:end], start)
        )

    @cached_property
    def _spoken(self) -> frozenset[int]:
        spoken = frozenset(k for a, b in (*self.texts(), *self.spoken()) for k in range(a, b))
        return spoken - self._english

    @cached_property
    def _english(self) -> frozenset[int]:
        """Positions in elements that are marked as English in every language."""
        return frozenset(k for tag in self._tags if ENGLISH in tag.group() for k in range(tag.start(), self._end(tag)))

    def _end(self, first: re.Match[str]) -> int:
        depth = 0
        for tag in self._tags:
            if tag.start() >= first.start() and tag[2] == first[2]:
                depth += -1 if tag[1] else 1
                if depth == 0:
                    return tag.end()
        return len(self.flat)

    def messages(self) -> Iterator[TemplateMessage]:
        """Every message, in order: of texts and of attributes for people."""
        matches = [f for start, end in self._runs() for f in self._inside(start, end)]
        matches += [f for start, end in self.spoken() if (f := self._message(start, end))]
        yield from sorted((f for f in matches if f.start not in self._english), key=lambda f: f.start)

    def spoken(self) -> Iterator[tuple[int, int]]:
        """Positions of the attributes for people."""
        for tag in self._tags:
            for attribute in ATTRIBUTE.finditer(tag.group()):
                if attribute[1] in TEXT_ATTRIBUTES or attribute[1].startswith(SCRIPT_TEXT_PREFIX):
                    yield tag.start() + attribute.start(2), tag.start() + attribute.end(2)

    def texts(self) -> Iterator[tuple[int, int]]:
        """Everything between tags."""
        position = 0
        for tag in self._tags:
            yield position, tag.start()
            position = tag.end()
        yield position, len(self.flat)

    def _runs(self) -> Iterator[tuple[int, int]]:
        """Runs between block tags, statements, pictures, and inline tags without their partner."""
        cuts = [(t.start(), t.end()) for t in self._tags if t[2] not in INLINE]
        cuts += [(k, k + 1) for a, b in self.texts() for k in range(a, b) if self._cuts(self.flat[k])]
        position = 0
        for start, end in [*sorted(cuts), (len(self.flat), len(self.flat))]:
            yield from self._paired(position, start)
            position = end

    def _cuts(self, char: str) -> bool:
        part = self.part(char)
        return bool(part) and not part.startswith(("{{", "<code"))

    def _paired(self, start: int, end: int) -> Iterator[tuple[int, int]]:
        """A run, cut where an inline tag has no partner in it."""
        opened, unpaired = list[re.Match[str]](), list[re.Match[str]]()
        for tag in self._tags:
            if start <= tag.start() and tag.end() <= end:
                if not tag[1]:
                    opened.append(tag)
                elif opened:
                    opened.pop()
                else:
                    unpaired.append(tag)
        position = start
        for tag in sorted((*unpaired, *opened), key=lambda t: t.start()):
            yield position, tag.start()
            position = tag.end()
        yield position, end

    def _inside(self, start: int, end: int) -> Iterator[TemplateMessage]:
        """The messages of a run: itself, or those of its elements where there is no text between them."""
        elements = self._elements(start, end)
        between, at = "", start
        for a, b, _, _ in elements:
            between, at = between + self.flat[at:a], b
        if elements and not LETTERS.search(between + self.flat[at:end]):
            for _, _, a, b in elements:
                yield from self._inside(a, b)
        elif found := self._message(start, end):
            yield found

    def _elements(self, start: int, end: int) -> list[tuple[int, int, int, int]]:
        """The outermost elements of a run: start, end, and the same of their content."""
        elements, depth, first = list[tuple[int, int, int, int]](), 0, None
        for tag in self._tags:
            if not (start <= tag.start() and tag.end() <= end):
                continue
            depth += -1 if tag[1] else 1
            if depth == 1 and first is None:
                first = tag
            elif depth == 0 and first is not None:
                elements.append((first.start(), tag.end(), first.end(), tag.start()))
                first = None
        return elements

    def _message(self, start: int, end: int) -> TemplateMessage | None:
        text = self.flat[start:end]
        start, end = start + len(text) - len(text.lstrip()), end - len(text) + len(text.rstrip())
        if not LETTERS.search(TAG.sub("", self.flat[start:end])):
            return None
        piece, position, names = Piece(), start, list[str]()
        for tag in (*(t for t in self._tags if start <= t.start() < end), None):
            stop = end if tag is None else tag.start()
            for char in self.flat[position:stop]:
                part = self.part(char)
                if part.startswith("{{"):
                    piece.expression(part)
                elif part:
                    piece.put(part, "code")
                else:
                    piece.add(char)
            if tag is not None:
                position = tag.end()
                if tag[1]:
                    piece.add(f"</{names.pop()}>")
                else:
                    names.append(piece.tag(tag.group(), tag[2]))
        return TemplateMessage(start, end, piece.message(self.name), piece)


def translating(expression: str) -> str:
    """The expression with its value translated; names and texts written by people stay."""
    if PERSONAL_EXPRESSIONS.search(expression):
        return expression
    return f"{{{{ ({expression[2:-2].strip()})|translated }}}}"
