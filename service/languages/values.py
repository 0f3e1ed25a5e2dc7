"""Numbers with their measure, ``+62.5 ± 1.2 µg``, in a language whose decimal sign is a comma."""

import re
from collections.abc import Callable

_NUMBER = r"\d+(?:,\d{3})*(?:\.\d+)?"
VALUE = re.compile(rf"([+−±]?{_NUMBER}(?:(?:\s±\s|–|…){_NUMBER})?)(\s?)([^\s\d.,:;]*)(\s*)")
"""A text that is one number, or a range, and at most one measure."""
NARROW = "\u202f"
"""Between thousands."""


def value_in(text: str, say: Callable[[str], str]) -> str:
    """A number with its measure; any other text as it is."""
    found = VALUE.fullmatch(text)
    if found is None:
        return text
    number, gap, label, rest = found.groups()
    measure = "/".join(map(say, label.split("/")))
    return f"{number.replace(',', NARROW).replace('.', ',')}{gap}{measure}{rest}"
