"""Names of units, types and stands, which appear in addresses, lists and on labels."""

import unicodedata

from estimator.message import say

LONGEST_NAME = 200
"""Characters of a name: the width of its columns in the store."""
INVISIBLE = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")
"""Categories of invisible characters: control, format (direction, zero width), surrogate, private, unassigned, line
ends."""
DOT_SEGMENTS = ("", ".", "..")
"""Parts between slashes that browsers remove from an address."""


def plain_name(text: str) -> str:
    """A name as it is stored: composed (NFC), trimmed, with single spaces."""
    return " ".join(unicodedata.normalize("NFC", text).split())


def fault_of_name(text: str) -> str | None:
    """The fault of a name; None where there is none."""
    if len(text) > LONGEST_NAME:
        return say(
            "is {length} characters long; at most {longest_name} are kept", length=len(text), longest_name=LONGEST_NAME
        )
    if any(unicodedata.category(c) in INVISIBLE for c in text):
        return "contains invisible characters, such as control characters or direction marks; remove them"
    if text and any(part in DOT_SEGMENTS for part in text.split("/")):
        return "cannot be part of an address: it has ., .. or nothing between slashes; change it"
    return None


def fault_of_serial(text: str) -> str | None:
    """The fault of a serial number, which is required; None where there is none."""
    return fault_of_name(text) if text else "is empty; write the unit's serial number"
