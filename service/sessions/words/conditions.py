"""A verdict in words, colour and shape: the same three everywhere."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from estimator.message import joined, say
from service.kit.measures import day_of
from service.sessions.decision import Verdict
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation, Reservations
from service.sessions.states import RecordState, StateChange


@dataclass(frozen=True)
class Condition:
    """Presentation of one verdict. ``key`` is also the name of its icon and its style."""

    key: str
    word: str
    """Word for a unit, a session or a parameter, to be read from across the room."""
    shape: str
    """The mark in charts (Vega's name), the same as the icon's outline."""
    meaning: str
    reserved: bool = False
    """Whether the verdict has a reservation; the mark beside it shows that too."""

    @property
    def rank(self) -> int:
        """Place in the order of attention, 0 first; what no rule judged comes last."""
        return RANKS.get(self.key, len(CONDITIONS))


UNFIT = Condition("fail", "Unfit", "square", "Out of tolerance, by more than the uncertainty of the measurement.")
PROBABLY_UNFIT = Condition(
    "conditional-fail", "Probably unfit", "diamond",
    "Out of tolerance, but by less than the uncertainty of the measurement.",
)  # fmt: skip
UNDECIDED = Condition(
    "undecidable", "Undecided", "cross",
    "The session does not observe this, or not well enough to judge it against the tolerance.",
)  # fmt: skip
PROBABLY_FIT = Condition(
    "conditional-pass", "Probably fit", "triangle-up",
    "Within tolerance, but closer to it than the uncertainty of the measurement.",
)  # fmt: skip
FIT = Condition("pass", "Fit", "circle", "Within tolerance, by more than the uncertainty of the measurement.")
REFERENCE = Condition(
    "reference", "Reference set", "triangle-right",
    "Later sessions are judged against it; it is not judged itself.",
)  # fmt: skip
NOT_MEASURED = Condition("none", "No calibration yet", "stroke", "No session of it counts yet.")
QUESTIONED = Condition(
    "none", "Questioned", "stroke", "Its file cannot be right; it counts once an engineer accepts it."
)
NOT_JUDGED = Condition("none", "Not judged", "circle", "No tolerance or no reference is set.")

CONDITIONS = (UNFIT, PROBABLY_UNFIT, UNDECIDED, PROBABLY_FIT, FIT)
"""Conditions, worst first, as they are listed."""
RANKS = {condition.key: rank for rank, condition in enumerate(CONDITIONS)}
"""Place by key."""
WITH_RESERVATION = "with reservation"
"""Addition to the word of a verdict that has a reservation."""
RESERVED = Condition(
    "reserved", "With reservation", "stroke",
    "A finding about the session qualifies the verdict; it is stated.",
)  # fmt: skip

_BY_VERDICT = {
    Verdict.FAIL: UNFIT,
    Verdict.CONDITIONAL_FAIL: PROBABLY_UNFIT,
    Verdict.UNDECIDABLE: UNDECIDED,
    Verdict.CONDITIONAL_PASS: PROBABLY_FIT,
    Verdict.PASS: FIT,
}


def condition_of(verdict: Verdict | None, *, is_reference: bool = False) -> Condition:
    """The presentation of a verdict; None is a unit without a session. A reference is undecidable for a good reason."""
    if is_reference and verdict is Verdict.UNDECIDABLE:
        return REFERENCE
    return NOT_MEASURED if verdict is None else _BY_VERDICT[verdict]


def said_with(condition: Condition, reservations: Reservations) -> Condition:
    """The condition, marked where it has a reservation: ``Fit, with reservation``."""
    if not reservations:
        return condition
    return replace(
        condition,
        word=say("{verdict}, {with_reservation}", verdict=condition.word, with_reservation=WITH_RESERVATION),
        reserved=True,
    )


STATES = {
    RecordState.ACCEPTED: "Accepted",
    RecordState.QUESTIONED: "Questioned",
    RecordState.WITHDRAWN: "Withdrawn",
    RecordState.SUPERSEDED: "Superseded",
}
MEANINGS = {
    RecordState.ACCEPTED: "",
    RecordState.QUESTIONED: (
        "It is stored and plotted; until an engineer accepts it, it is no reference and has no verdict."
    ),
    RecordState.WITHDRAWN: "It stays readable; nothing about the unit is based on it.",
    RecordState.SUPERSEDED: "Another session replaces it.",
}


def state_in_words(change: StateChange) -> str:
    """``Withdrawn on 21 Nov 2026 by K. Ito: wrong unit``."""
    parts = {"states": STATES[change.state], "date": day_of(change.at), "who": change.who, "reason": change.why}
    return say("{states} on {date} by {who}: {reason}", **parts)


LOOKING = "the search for causes is not finished"
STILL_LOOKING = say("; {looking}", looking=LOOKING)
MOST_TOLD = 2
"""Most reservations that a verdict names before the rest are counted: more are hard to read at once."""


def but(reservations: Reservations) -> str:
    """The reservations after a verdict's word; empty where there are none."""
    if reservations is None:
        return STILL_LOOKING
    if not reservations:
        return ""
    return say(", {reservations}", reservations=but_alone(reservations))


def but_alone(reservations: Reservations) -> str:
    """The reservations where no word stands before them."""
    if reservations is None:
        return LOOKING
    named, more = reservations[:MOST_TOLD], len(reservations) - MOST_TOLD
    rest = say("; and {number} more", number=more) if more > 0 else ""
    return say(
        "but {reservations}{rest}: {advice}",
        reservations=joined("; and ", (reservation.text for reservation in named)),
        rest=rest,
        advice=advice_of(named),
    )


def advice_of(reservations: Sequence[Reservation]) -> str:
    """The one thing to do first: a wrong file is corrected before anything else, and advice that says more comes before
    what it holds. Empty without reservations."""
    of_record = [reservation for reservation in reservations if reservation.kind is Doubt.RECORD]
    advice = [reservation.advice for reservation in of_record or reservations]
    whole = (one for one in advice if not any(one in other for other in advice if other != one))
    return next(whole, "")
