"""A verdict in words, colour and shape: the same three everywhere."""

from dataclasses import dataclass, replace

from estimator.message import say
from service.sessions.decision import Verdict
from service.sessions.doubt import Reservations


@dataclass(frozen=True)
class Condition:
    """How one verdict is shown. ``key`` is also the name of its icon and its style."""

    key: str
    word: str
    """For a unit or a session, read from across the room."""
    formal: str
    """The name of the decision rule's state."""
    shape: str
    """The mark in charts (Vega's name), the same as the icon's outline."""
    meaning: str
    reserved: bool = False
    """Whether the verdict is said with a reservation; the mark beside it says so too."""

    @property
    def rank(self) -> int:
        """Place in the order of attention, 0 first; what no rule judged comes last."""
        return RANKS.get(self.key, len(CONDITIONS))


UNFIT = Condition(
    "fail", "Unfit", "fail", "square", "Out of tolerance, by more than the uncertainty of the measurement."
)
PROBABLY_UNFIT = Condition(
    "conditional-fail", "Probably unfit", "conditional fail", "diamond",
    "Out of tolerance, but by less than the uncertainty of the measurement.",
)  # fmt: skip
UNDECIDED = Condition(
    "undecidable", "Undecided", "undecidable", "cross",
    "The session does not observe this, or not well enough to judge it against the tolerance.",
)  # fmt: skip
PROBABLY_FIT = Condition(
    "conditional-pass", "Probably fit", "conditional pass", "triangle-up",
    "Within tolerance, but closer to it than the uncertainty of the measurement.",
)  # fmt: skip
FIT = Condition("pass", "Fit", "pass", "circle", "Within tolerance, by more than the uncertainty of the measurement.")
REFERENCE = Condition(
    "reference", "Reference set", "reference", "triangle-right",
    "The session that later ones are judged against; there was nothing to judge it by.",
)  # fmt: skip
NOT_MEASURED = Condition("none", "Not measured", "no session", "stroke", "No session has been uploaded yet.")
QUESTIONED = Condition(
    "none",
    "Questioned",
    "questioned",
    "stroke",
    "It cannot be as its file says, and counts once an engineer accepts it.",
)
NOT_JUDGED = Condition("none", "Not judged", "not judged", "circle", "No tolerance or no reference is set.")

CONDITIONS = (UNFIT, PROBABLY_UNFIT, UNDECIDED, PROBABLY_FIT, FIT)
"""Worst first, as they are listed."""
RANKS = {condition.key: rank for rank, condition in enumerate(CONDITIONS)}
"""Place by key."""
WITH_RESERVATION = "with reservation"
"""What is added to the word of a verdict that something speaks against."""
RESERVED = Condition(
    "reserved", "With reservation", WITH_RESERVATION, "stroke",
    "Something that was found about the session speaks against taking the verdict as it stands; it says what.",
)  # fmt: skip

_BY_VERDICT = {
    Verdict.FAIL: UNFIT,
    Verdict.CONDITIONAL_FAIL: PROBABLY_UNFIT,
    Verdict.UNDECIDABLE: UNDECIDED,
    Verdict.CONDITIONAL_PASS: PROBABLY_FIT,
    Verdict.PASS: FIT,
}


def condition_of(verdict: Verdict | None, *, is_reference: bool = False) -> Condition:
    """How a verdict is shown; None is a unit without a session. A reference is undecidable for a good reason."""
    if is_reference and verdict is Verdict.UNDECIDABLE:
        return REFERENCE
    return NOT_MEASURED if verdict is None else _BY_VERDICT[verdict]


def said_with(condition: Condition, reservations: Reservations) -> Condition:
    """The same verdict, marked where it is said with a reservation: ``Fit, with reservation``."""
    if not reservations:
        return condition
    return replace(
        condition,
        word=say("{word}, {with_reservation}", word=condition.word, with_reservation=WITH_RESERVATION),
        reserved=True,
    )
