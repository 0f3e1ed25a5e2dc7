"""Verdicts with what they are said with."""

from dataclasses import dataclass
from typing import Any

from service.fleet.condition import UnitSummary
from service.judging.words import AGAIN, verdict_in_words
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation
from service.sessions.records import Receipt, StoredSession
from service.sessions.states import RecordState
from service.sessions.words.conditions import QUESTIONED, condition_of
from service.sessions.words.reservations import LOOKING

STILL_LOOKING = Reservation(Doubt.PENDING, LOOKING, AGAIN)
"""Of a verdict whose session is not diagnosed yet."""


@dataclass(frozen=True, kw_only=True)
class SaidVerdict:
    """A verdict that is said with its reservations."""

    reservations: tuple[Reservation, ...]
    """What speaks against taking the verdict as it stands; one of kind `pending` while causes are still being looked
    for. Empty where the verdict is plain."""
    said: str
    """The verdict in words, in one breath with its reservations."""


def said(record: StoredSession | Receipt | UnitSummary) -> dict[str, Any]:
    """The fields of a record with a verdict, and how that is said; a questioned session tells nothing."""
    known = record.reservations
    words = verdict_in_words(condition_of(record.verdict, is_reference=record.is_reference), known)
    if not isinstance(record, UnitSummary) and record.state is RecordState.QUESTIONED:
        words = QUESTIONED.word
    return {**vars(record), "reservations": (STILL_LOOKING,) if known is None else known, "said": words}
