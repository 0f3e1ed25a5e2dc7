"""Plain English of page templates, handed to gettext without marks.

Text between tags and in attributes for people becomes ``{{ _("text") }}``, a value there ``{{ value|translated }}``, as
if the author had written so. A sentence with values or inline tags in it is written as ``{% trans %}``.
"""

import re
from collections.abc import Iterable, Iterator

from jinja2.ext import Extension
from jinja2.lexer import Token, TokenStream

WORDS = re.compile(r"(?<![&A-Za-z])[A-Za-z]{2}")
"""Pattern of what is to be translated; names of entities are none."""
MARKUP = re.compile(r"<(script|style|svg|code)\b.*?</\1>|<(\w+)\b[^<>]*\slang=\"en\".*?</\2>|<[^<>]*>", re.DOTALL)
"""A tag, or an element without words, or one that is English in every language (none holds another of its kind)."""
ATTRIBUTE = re.compile(r'\b(?:alt|aria-label|data-label|data-said-\w+|label|placeholder|title)="([^"]*)"')
OF_PEOPLE = frozenset(
    (
        *("account", "address", "filename", "issued_by", "login", "lot", "note", "notes", "operator", "serial"),
        *("stand", "unit", "unit_type", "why"),
    )
)
"""Last names of values that people wrote, and of addresses."""
FIRST = 0xF0000
"""Private characters of Unicode stand for statements and expressions while the HTML around them is read."""
PLACES = re.compile(f"([{chr(FIRST)}-{chr(0xFFFFD)}])")


class PlainText(Extension):
    """Marks for gettext in the tokens of a template."""

    def filter_stream(self, stream: TokenStream) -> Iterator[Token]:
        """The template with marks."""
        flat, places = flattened(stream)
        line = 1
        for text, is_read in parts_of(flat):
            for piece in PLACES.split(text):
                if PLACES.match(piece):
                    tokens = places[ord(piece) - FIRST]
                    line = tokens[-1].lineno
                    yield from _translated(tokens) if is_read else tokens
                elif is_read and WORDS.search(piece):
                    words = " ".join(piece.split())
                    before, after = re.split(r"\S.*\S", piece, maxsplit=1, flags=re.DOTALL)
                    yield Token(line, "data", before)
                    yield from _called(line, words.replace("%", "%%"))
                    yield Token(line, "data", after)
                elif piece:
                    yield Token(line, "data", piece)
                line += piece.count("\n")


def flattened(stream: Iterable[Token]) -> tuple[str, list[list[Token]]]:
    """A template with one character for every statement, expression and whole ``{% trans %}``; these in order."""
    flat, places, tokens = "", list[list[Token]](), list[Token]()
    is_sentence = False
    for token in stream:
        if token.type == "data" and not is_sentence:
            flat += token.value
            continue
        tokens.append(token)
        if token.type in ("variable_end", "block_end"):
            is_sentence = "endtrans" not in _names(tokens) and (is_sentence or "trans" in _names(tokens[:2]))
            if not is_sentence:
                flat += chr(FIRST + len(places))
                places.append(tokens)
                tokens = []
    return flat, places


def parts_of(flat: str) -> Iterator[tuple[str, bool]]:
    """The parts of a flat template, and whether people read them."""
    position = 0
    for tag in MARKUP.finditer(flat):
        yield flat[position : tag.start()], True
        position = tag.start()
        for value in () if tag[1] or tag[2] else ATTRIBUTE.finditer(flat, tag.start(), tag.end()):
            yield flat[position : value.start(1)], False
            yield value[1], True
            position = value.end(1)
        yield flat[position : tag.end()], False
        position = tag.end()
    yield flat[position:], True


def _names(tokens: list[Token]) -> list[str]:
    return [token.value for token in tokens if token.type == "name"]


def _called(line: int, words: str) -> Iterator[Token]:
    yield Token(line, "variable_begin", "{{")
    yield Token(line, "name", "_")
    yield Token(line, "lparen", "(")
    yield Token(line, "string", words)
    yield Token(line, "rparen", ")")
    yield Token(line, "variable_end", "}}")


def _translated(tokens: list[Token]) -> Iterator[Token]:
    """An expression with its value translated; a statement, and what people wrote, as it is."""
    first, *inner, last = tokens
    if first.type != "variable_begin" or inner[-1].value in OF_PEOPLE:
        yield from tokens
        return
    line = last.lineno
    yield from (first, Token(line, "lparen", "("), *inner, Token(line, "rparen", ")"))
    yield from (Token(line, "pipe", "|"), Token(line, "name", "translated"), last)
