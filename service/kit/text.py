"""Text that people write, and what no text holds."""

import re

UNTYPED = r"\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff"
"""Control characters but tab and line feed, the separators of lines and paragraphs, halves of surrogate pairs: nobody
types them. Databases, mail, calendars and papers refuse each some of them, or read them as the end of a line."""
CONTROL = re.compile(f"[{UNTYPED}]")


def without_control(text: str) -> str:
    """The text with its lines ended by line feeds, and a space for every control character."""
    return CONTROL.sub(" ", text.replace("\r\n", "\n").replace("\r", "\n"))


def in_one_line(text: str) -> str:
    """The text with one space wherever it has spaces, ends of lines or control characters."""
    return " ".join(without_control(text).split())
