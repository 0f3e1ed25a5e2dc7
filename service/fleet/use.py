"""Permitted use of a unit: the four answers, worded the same everywhere."""

from collections.abc import Iterator, Mapping
from datetime import timedelta
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


SLACK = timedelta(days=1)
"""Time by which a session may be dated ahead: a clock may be in another zone than it says."""
RANKS = {Use.NO: 0, Use.PENDING: 1, Use.RESERVED: 2, Use.YES: 3}
"""Places in the order of attention."""
WORDS = {
    Use.YES: "May be used",
    Use.RESERVED: "May be used with reservation",
    Use.NO: "Do not use",
    Use.PENDING: "Do not use yet",
}

COUNTED = (Use.NO, Use.RESERVED, Use.YES)
"""Answers that are counted even where no unit has them."""
COUNT_WORDS = {
    Use.NO: "must not be used",
    Use.PENDING: "must not be used yet",
    Use.RESERVED: "with reservation",
    Use.YES: "may be used",
}
"""The answers after a number of units."""
TONES = {Use.NO: "fail", Use.PENDING: "undecidable", Use.RESERVED: "conditional-pass", Use.YES: "pass"}
"""Colours and marks of the answers."""


def counted_uses(found: Mapping[Use, int]) -> Iterator[tuple[Use, int]]:
    """The answers that are counted, each with its number of units, those that must not be used first."""
    for use in sorted(Use, key=RANKS.__getitem__):
        if found.get(use) or use in COUNTED:
            yield use, found.get(use, 0)


def in_words(use: Use, action: str) -> str:
    """``Do not use: repeat the session``."""
    return say("{word}: {action}", word=WORDS[use], action=action) if action else WORDS[use]
