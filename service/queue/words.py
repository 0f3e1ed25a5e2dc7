"""Pending background work in words."""

from collections.abc import Iterator, Mapping

from estimator.message import joined, say, say_count
from service.queue.records import WorkKind

PENDING = "Still being worked out: {what}. Reservations, flags, counts and dates may change until then."
SUMMARY = "what types and stands show"


def pending_in_words(counts: Mapping[WorkKind, int]) -> str:
    """One line of everything; empty where nothing is to be done that a page of the fleet shows."""
    parts = tuple(_parts(counts))
    return say(PENDING, what=joined(", ", parts)) if parts else ""


def _parts(counts: Mapping[WorkKind, int]) -> Iterator[str]:
    if sessions := counts.get(WorkKind.DIAGNOSIS):
        yield say_count("the diagnosis of {n} session", "the diagnoses of {n} sessions", sessions)
    if units := counts.get(WorkKind.OUTLOOK):
        yield say_count("the dates of {n} unit", "the dates of {n} units", units)
    if groups := counts.get(WorkKind.GROUP):
        yield say_count("what {n} group of sessions shows", "what {n} groups of sessions show", groups)
    if counts.get(WorkKind.SUMMARY):
        yield say(SUMMARY)
