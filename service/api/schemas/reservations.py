"""Verdicts with what they are said with."""

from dataclasses import dataclass
from typing import Any

from service.records.reservation import Doubt, Reservation
from service.records.session import Receipt, StoredSession
from service.records.state import RecordState
from service.records.unit import UnitSummary
from service.words.conditions import QUESTIONED, condition_of
from service.words.reservation import AGAIN, LOOKING
from service.words.verdict import verdict_in_words

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
