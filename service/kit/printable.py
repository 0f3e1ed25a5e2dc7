"""Text as the fonts of the documents can print it.

The fonts that come with typst hold Latin, Greek, Cyrillic and the signs of measurement. A character of another script,
and one that is not seen or turns the direction of writing, is printed as its code point, ``‹U+4F60›``: so a paper never
shows empty boxes, never says less than the record, and is the same on every machine.
"""

import re
from dataclasses import asdict
from functools import lru_cache
from typing import Any, TypeAlias
from unicodedata import category

from lxml.etree import _Element, tostring

from estimator.message import changed

RANGES = ((0x0020, 0x04FF), (0x1E00, 0x1FFF), (0x2000, 0x20CF), (0x2190, 0x22FF))
"""First and last code point of what can be printed."""
ABSENT = frozenset("\u2041\u2043\u2053")
"""Characters within the ranges, but in neither font."""
UNSEEN = frozenset({"Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"})
"""Categories of Unicode that leave no mark on paper, or turn the direction of writing."""
BREAKS = frozenset("\n\t")
"""Unseen too, but meant."""


def printable(text: str) -> str:
    """The text with every character that cannot be printed as its code point."""
    if text.isascii() and text.isprintable():
        return text
    return _unprintable().sub(lambda found: f"‹U+{ord(found[0]):04X}›", text)


@lru_cache(maxsize=1)
def _unprintable() -> re.Pattern[str]:
    """Every other character: pictures are long texts, and are looked through as fast as they can be."""
    inside = (chr(code) for low, high in RANGES for code in range(low, high + 1))
    return re.compile(f"[^{re.escape(''.join(filter(is_printable, (*inside, *BREAKS))))}]")


def is_printable(character: str) -> bool:
    """Whether a document can show the character."""
    if character in BREAKS:
        return True
    inside = any(low <= ord(character) <= high for low, high in RANGES)
    return inside and character not in ABSENT and category(character) not in UNSEEN


def printable_data(record: Any) -> Any:
    """A frozen record as plain dicts and lists, every text of it printable."""
    return _printable(asdict(record))


def _printable(value: Any) -> Any:
    match value:
        case str():
            return changed(value, printable)
        case dict():
            return {key: _printable(inner) for key, inner in value.items()}
        case list() | tuple():
            return [_printable(inner) for inner in value]
        case _:
            return value


Element: TypeAlias = _Element
"""A part of a tree."""
ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 (section 2.2, Char) cannot hold."""


def document(root: Element) -> bytes:
    """The file: the same tree gives the same bytes."""
    written: bytes = tostring(root, encoding="utf-8", xml_declaration=True, pretty_print=True)
    return written


def sealed_document(root: Element) -> bytes:
    """The file of a tree that is signed as it stands: not a space is added."""
    written: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return written
