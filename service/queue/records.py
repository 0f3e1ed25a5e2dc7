"""Background work in the queue."""

from dataclasses import dataclass
from datetime import datetime
from enum import IntEnum, StrEnum


class WorkKind(StrEnum):
    """Kinds of queued work, under the same names as in `FailedKind`."""

    DIAGNOSIS = "diagnosis"
    """Diagnosis of a session, by its identifier."""
    OUTLOOK = "outlook"
    """Outlook of a unit, by its serial number."""
    DERIVATION = "derivation"
    """Verdicts of a unit after a change of its records: only failures are stored, by serial number."""
    GROUP = "group"
    """Findings in the sessions of a unit, a unit type or a stand together, by `Group.place`."""
    SUMMARY = "summary"
    """Drift of the units of a type, or the state of stands, by `Group.place`."""
    RECOMPUTATION = "recomputation"
    """A unit's sessions under another model, by `Task.key`."""
    JOB = "job"
    """A piece of a long job, by the number of the job."""
    UPLOAD = "upload"
    """A long file that was received completely, by the number of its job."""
    MESSAGE = "message"
    """Message to a webhook, by the number of its delivery."""


class Rank(IntEnum):
    """Place of a piece of work in the order of all background work: the lowest is done first, and of equal ones the
    oldest request."""

    AWAITED = 0
    """Somebody looks at the page that shows it."""
    UPLOADED = 1
    """Somebody uploaded or asked for what it is about."""
    FOLLOWING = 2
    """It rests on the results of many sessions: groups, summaries, recomputations."""
    DEMONSTRATION = 3
    """It is about the demonstration fleet alone."""
    FOLLOWING_DEMONSTRATION = 4
    """It rests on the results of the demonstration fleet alone."""


FOLLOWING = frozenset({WorkKind.GROUP, WorkKind.SUMMARY, WorkKind.RECOMPUTATION})
"""Kinds that rest on what others find: done before these, they would be done again."""


def rank_of(kind: WorkKind, *, is_demonstration: bool) -> Rank:
    """Rank of work that nobody looks at."""
    if is_demonstration:
        return Rank.FOLLOWING_DEMONSTRATION if kind in FOLLOWING else Rank.DEMONSTRATION
    return Rank.FOLLOWING if kind in FOLLOWING else Rank.UPLOADED


class WorkState(StrEnum):
    """Whether it is still attempted."""

    WAITING = "waiting"
    FAILED = "failed"
    """Given up: attempted again on a new request."""


@dataclass(frozen=True)
class Waiting:
    """A piece of pending work."""

    ticket: str
    """Changes whenever the input of the work changes: a result made under an older ticket is not stored."""
    not_before: datetime | None
    """Time of the next attempt after a failed one; None where there was none."""
    failed: str
    """Reason of the last failed attempt; empty where none failed."""
    rank: Rank
