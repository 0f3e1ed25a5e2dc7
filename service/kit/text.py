"""Text that people write, and what no text holds: characters that nobody types.

Databases, mail, calendars and papers refuse each some of them, or read them as the end of a line. Ranges are written as
inside the brackets of a regular expression, which JSON Schema has too.
"""

import re

from estimator.message import say

NUL = r"\x00"
"""The one character that PostgreSQL cannot hold."""
OF_LINES = r"\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u2028\u2029"
"""Control characters but tabs and ends of lines, and the separators of lines and paragraphs."""
OF_A_LINE = r"\x00-\x1f\x7f-\x9f\u2028\u2029"
"""All control characters, tabs and ends of lines included, and the separators of lines and paragraphs."""
_SURROGATES = r"\ud800-\udfff"
"""Halves of pairs, which no encoding can hold."""


def fault_of_text(text: str, refused: str = OF_LINES, *, is_required: bool = False) -> str | None:
    """The fault of a text; None where it has none."""
    if is_required and not text.strip():
        return "must not be blank"
    found = re.search(f"[{refused}{_SURROGATES}]", text)
    return None if found is None else say("contains the control character {code}; remove it", code=_code(found[0]))


def _code(character: str) -> str:
    return f"U+{ord(character):04X}"


def with_plain_ends(text: str) -> str:
    """The text with its lines ended by line feeds."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def without_control(text: str) -> str:
    """The same, with a space for every control character but tabs."""
    return re.sub(f"[{OF_LINES}{_SURROGATES}]", " ", with_plain_ends(text))


def in_one_line(text: str) -> str:
    """The text with one space wherever it has spaces, ends of lines or control characters."""
    return " ".join(without_control(text).split())
