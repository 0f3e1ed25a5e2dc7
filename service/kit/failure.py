"""Background work that has failed."""

from dataclasses import dataclass
from enum import StrEnum

from estimator.message import say, without_stop
from service.kit.answer import answer

AT_FAULT = "the program failed at it: see the log"
"""Reason in place of Python's words."""


def too_long(seconds: float) -> str:
    """The reason for a piece of work that was ended at its limit of time."""
    return say("it was not finished within the limit of {seconds} s", seconds=f"{seconds:g}")


class FailedKind(StrEnum):
    """Kinds of background work."""

    DIAGNOSIS = "diagnosis"
    """Diagnosis of a session."""
    OUTLOOK = "outlook"
    """Outlook of a unit: its drift, its forecast and its due date."""
    DERIVATION = "derivation"
    """Verdicts of a unit after a change of its records."""
    GROUP = "group"
    """Joint diagnosis of the sessions of a unit, a unit type or a stand."""
    SUMMARY = "summary"
    """Drift of the units of a type, or health of the stands."""
    RECOMPUTATION = "recomputation"
    """Recomputation of a unit's sessions under another model."""
    JOB = "job"
    """Long work that somebody asked for."""
    MESSAGE = "message"
    """Message to another program."""


@answer
@dataclass(frozen=True)
class Failed:
    """One piece of background work that has failed."""

    kind: FailedKind
    """Kind of the work."""
    of: str
    """Session, unit, group, job or address."""
    why: str
    """Reason for the failure, in short; the log says more."""


UNIT = (
    "Its dates and verdicts could not be computed with its latest records: {why}. The administrator must act: see "
    "Failed work on the page Jobs, and the log."
)
SESSION = "Its diagnosis failed: {why}. The administrator must act: see Failed work on the page Jobs, and the log."
GROUP = (
    "What these sessions show together could not be computed: {why}. The administrator must act: see Failed work on "
    "the page Jobs, and the log."
)
NAMES = {
    FailedKind.DIAGNOSIS: "Diagnosis of a session",
    FailedKind.OUTLOOK: "Dates of a unit",
    FailedKind.DERIVATION: "Verdicts of a unit after a change of its records",
    FailedKind.GROUP: "What sessions show together",
    FailedKind.SUMMARY: "Summary of a type or of the stands",
    FailedKind.RECOMPUTATION: "Sessions of a unit under another model",
    FailedKind.JOB: "Job",
    FailedKind.MESSAGE: "Message to another program",
}


def with_last_try(text: str, why: str) -> str:
    """The failed work, and the end of its last attempt where that is known."""
    return say("{failure} The last try: {reason}.", failure=text, reason=without_stop(why)) if why else text


def unit_failed(reason: str) -> str:
    """The sentence for a unit."""
    return say(UNIT, why=without_stop(reason))


def session_failed(reason: str) -> str:
    """The sentence for a session."""
    return say(SESSION, why=without_stop(reason))


def group_failed(reason: str) -> str:
    """The sentence for a unit, a unit type or a stand."""
    return say(GROUP, why=without_stop(reason))
