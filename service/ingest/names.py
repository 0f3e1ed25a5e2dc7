"""Names of units, types and stands: written once, found in addresses, lists and on labels ever after."""

import unicodedata

from estimator.message import say

LONGEST_NAME = 200
"""Characters of a name that the store keeps: the width of its columns."""
UNSEEN = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")
"""Kinds of characters that nobody sees: control, direction of writing, no width, half of a pair, private, unassigned,
and ends of lines."""
STEPS = ("", ".", "..")
"""Between slashes: what browsers take out of an address."""


def plain_name(text: str) -> str:
    """A name as it is kept: composed (NFC), without space around it, one space for several."""
    return " ".join(unicodedata.normalize("NFC", text).split())


def fault_of_name(text: str) -> str | None:
    """What is wrong with a name; None where nothing is."""
    if len(text) > LONGEST_NAME:
        return say(
            "is {text} characters long; at most {longest_name} are kept", text=len(text), longest_name=LONGEST_NAME
        )
    if any(unicodedata.category(c) in UNSEEN for c in text):
        return "contains invisible characters, such as control characters or direction marks; remove them"
    if text and any(part in STEPS for part in text.split("/")):
        return "cannot be part of an address: it has ., .. or nothing between slashes; change it"
    return None


def fault_of_serial(text: str) -> str | None:
    """The same of a serial number, which cannot be left out."""
    return fault_of_name(text) if text else "is empty; write the unit's serial number"
