"""What follows the word of a verdict: its reservations, and what to do about them."""

from collections.abc import Sequence

from estimator.message import joined, say
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation, Reservations

LOOKING = "causes are still being looked for"
STILL_LOOKING = say("; {looking}", looking=LOOKING)
MOST_TOLD = 2
"""Reservations that a verdict is said with before the rest are counted: more are no longer read in one breath."""


def but(reservations: Reservations) -> str:
    """What follows a verdict's word: nothing where it is plain."""
    if reservations is None:
        return STILL_LOOKING
    if not reservations:
        return ""
    return say(", {but}", but=but_alone(reservations))


def but_alone(reservations: Reservations) -> str:
    """The same where no word stands before it."""
    if reservations is None:
        return LOOKING
    told, more = reservations[:MOST_TOLD], len(reservations) - MOST_TOLD
    rest = say("; and {more} more", more=more) if more > 0 else ""
    return say(
        "but {text}{rest}: {told}",
        text=joined("; and ", (one.text for one in told)),
        rest=rest,
        told=joined(" and ", _advice(told)),
    )


def _advice(told: Sequence[Reservation]) -> tuple[str, ...]:
    """What to do, once, and not what other advice says already; a wrong file is put right before anything else."""
    if any(one.kind is Doubt.RECORD for one in told):
        told = [one for one in told if one.kind is Doubt.RECORD]
    advice = tuple(dict.fromkeys(one.advice for one in told))
    return tuple(one for one in advice if not any(one in other for other in advice if other != one))
