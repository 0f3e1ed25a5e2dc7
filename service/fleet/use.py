"""Permitted use of a unit: the four answers, worded the same everywhere."""

from enum import StrEnum

from estimator.message import say


class Use(StrEnum):
    """Permitted use of a unit now."""

    YES = "yes"
    RESERVED = "with-reservation"
    """The unit may be used, and something must be known or done."""
    NO = "no"
    PENDING = "not-known-yet"
    """Its verdict or its dates are being worked out; until then the unit may not be used."""


RANKS = {Use.NO: 0, Use.PENDING: 1, Use.RESERVED: 2, Use.YES: 3}
"""Places in the order of attention."""
WORDS = {
    Use.YES: "May be used",
    Use.RESERVED: "May be used with reservation",
    Use.NO: "Do not use",
    Use.PENDING: "Do not use yet",
}


def in_words(use: Use, action: str) -> str:
    """``Do not use: repeat the session``."""
    return say("{word}: {action}", word=WORDS[use], action=action) if action else WORDS[use]
