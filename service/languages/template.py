"""The words of a page's template, found where they stand, without a mark.

A message is a run of text between block tags and statements, with its inline tags (without attributes) and with a
place for every expression. So whoever writes a page writes English and nothing else, and no text can be forgotten.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from service.languages.entry import Entry
from service.languages.pieces import Piece

INLINE = frozenset(("a", "abbr", "b", "em", "i", "small", "strong", "sub", "sup", "span", "time"))
"""Tags that may stand inside a sentence."""
SPOKEN = frozenset(("alt", "aria-label", "data-label", "label", "placeholder", "title"))
"""Attributes whose value is read by people."""
SAID_BY_SCRIPTS = "data-said-"
"""How attributes begin from which a script takes what it says."""
ENGLISH = ' lang="en"'
"""Marks an element that is left alone, as the description of the API."""
SILENT = re.compile(r"<(script|style|svg)\b.*?</\1>", re.DOTALL)
"""Elements that hold no words."""
CODE = re.compile(r"<code\b.*?</code>", re.DOTALL)
"""What is said to a machine stands in every language as it is."""
JINJA = re.compile(r"\{%.*?%\}|\{\{.*?\}\}|\{#.*?#\}", re.DOTALL)
TAG = re.compile(r"<(/?)([a-zA-Z][\w-]*)[^<>]*>|<![^<>]*>")
ATTRIBUTE = re.compile(r'([\w-]+)="([^"]*)"')
LETTERS = re.compile(r"[A-Za-z]{2,}")
THEIRS = re.compile(
    r"\b(serial|unit|unit_type|operator|stand|notes?|why|login|filename|lot|customer\.\w+|issued_by|account)\s*\}\}$"
)
"""Ends of expressions that say what people named or wrote."""
FIRST = 0xF0000
"""The private characters of Unicode stand for what is not HTML while HTML is looked at."""


@dataclass(frozen=True)
class Found:
    """A message in a template, between two places of its flat text."""

    start: int
    end: int
    message: Entry
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
        """What a character stands for; empty where it stands for itself."""
        return self._parts[ord(char) - FIRST] if ord(char) >= FIRST else ""

    def jinja(self) -> Iterator[tuple[str, bool]]:
        """Every expression and statement, and whether its value stands in what people read."""
        for k, char in enumerate(self.flat):
            if self.part(char).startswith(("{{", "{%")):
                yield self.part(char), k in self._told

    def whole(self, flat: str) -> str:
        """The source of a flat text."""
        return "".join(self.whole(self.part(c)) if ord(c) >= FIRST else c for c in flat)

    def spoken_source(self, start: int, end: int) -> str:
        """The source between two places; what expressions tell people is said in the language of the page."""
        return "".join(
            speaking(self.part(c)) if k in self._told and self.part(c).startswith("{{") else self.whole(c)
            for k, c in enumerate(self.flat[start:end], start)
        )

    @cached_property
    def _told(self) -> frozenset[int]:
        told = frozenset(k for a, b in (*self.texts(), *self.spoken()) for k in range(a, b))
        return told - self._english

    @cached_property
    def _english(self) -> frozenset[int]:
        """What stands in elements that say that they are English in every language."""
        return frozenset(k for tag in self._tags if ENGLISH in tag.group() for k in range(tag.start(), self._end(tag)))

    def _end(self, first: re.Match[str]) -> int:
        """Where an element ends."""
        depth = 0
        for tag in self._tags:
            if tag.start() >= first.start() and tag[2] == first[2]:
                depth += -1 if tag[1] else 1
                if depth == 0:
                    return tag.end()
        return len(self.flat)

    def messages(self) -> Iterator[Found]:
        """Every message, in order: of texts and of attributes that people read."""
        found = [f for start, end in self._runs() for f in self._inside(start, end)]
        found += [f for start, end in self.spoken() if (f := self._message(start, end))]
        yield from sorted((f for f in found if f.start not in self._english), key=lambda f: f.start)

    def spoken(self) -> Iterator[tuple[int, int]]:
        """Where the attributes stand that people read."""
        for tag in self._tags:
            for attribute in ATTRIBUTE.finditer(tag.group()):
                if attribute[1] in SPOKEN or attribute[1].startswith(SAID_BY_SCRIPTS):
                    yield tag.start() + attribute.start(2), tag.start() + attribute.end(2)

    def texts(self) -> Iterator[tuple[int, int]]:
        """Everything between tags."""
        at = 0
        for tag in self._tags:
            yield at, tag.start()
            at = tag.end()
        yield at, len(self.flat)

    def _runs(self) -> Iterator[tuple[int, int]]:
        """Between what ends a sentence: block tags, statements, pictures, and inline tags without their partner."""
        cuts = [(t.start(), t.end()) for t in self._tags if t[2] not in INLINE]
        cuts += [(k, k + 1) for a, b in self.texts() for k in range(a, b) if self._cuts(self.flat[k])]
        at = 0
        for start, end in [*sorted(cuts), (len(self.flat), len(self.flat))]:
            yield from self._paired(at, start)
            at = end

    def _cuts(self, char: str) -> bool:
        part = self.part(char)
        return bool(part) and not part.startswith(("{{", "<code"))

    def _paired(self, start: int, end: int) -> Iterator[tuple[int, int]]:
        """A run, cut where an inline tag has no partner in it."""
        opened, lone = list[re.Match[str]](), list[re.Match[str]]()
        for tag in self._tags:
            if start <= tag.start() and tag.end() <= end:
                if not tag[1]:
                    opened.append(tag)
                elif opened:
                    opened.pop()
                else:
                    lone.append(tag)
        at = start
        for tag in sorted((*lone, *opened), key=lambda t: t.start()):
            yield at, tag.start()
            at = tag.end()
        yield at, end

    def _inside(self, start: int, end: int) -> Iterator[Found]:
        """The messages of a run: itself, or what its elements hold where nothing is said between them."""
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
        """The outermost elements of a run: from, to, and the same of their content."""
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

    def _message(self, start: int, end: int) -> Found | None:
        text = self.flat[start:end]
        start, end = start + len(text) - len(text.lstrip()), end - len(text) + len(text.rstrip())
        if not LETTERS.search(TAG.sub("", self.flat[start:end])):
            return None
        piece, at, names = Piece(), start, list[str]()
        for tag in (*(t for t in self._tags if start <= t.start() < end), None):
            stop = end if tag is None else tag.start()
            for char in self.flat[at:stop]:
                part = self.part(char)
                if part.startswith("{{"):
                    piece.expression(part)
                elif part:
                    piece.put(part, "code")
                else:
                    piece.add(char)
            if tag is not None:
                at = tag.end()
                if tag[1]:
                    piece.add(f"</{names.pop()}>")
                else:
                    names.append(piece.tag(tag.group(), tag[2]))
        return Found(start, end, piece.message(self.name), piece)


def speaking(expression: str) -> str:
    """The expression, its value said in the language of the page; what people named or wrote stays as they did."""
    if THEIRS.search(expression):
        return expression
    return f"{{{{ ({expression[2:-2].strip()})|translated }}}}"
