"""Background work that has failed."""

from dataclasses import dataclass
from enum import StrEnum

from estimator.message import say, without_stop
from service.kit.answer import answer

AT_FAULT = "the program failed at it: see the log"
"""In place of Python's words."""


def too_long(seconds: float) -> str:
    """Of what was ended because it was not done in time."""
    return say("it was not finished within the limit of {seconds} s", seconds=f"{seconds:g}")


class FailedKind(StrEnum):
    """What is done in the background."""

    DIAGNOSIS = "diagnosis"
    """Of a session."""
    OUTLOOK = "outlook"
    """Of a unit: its drift, its forecast and its due date."""
    DERIVATION = "derivation"
    """Of a unit: verdicts after a change of its records."""
    GROUP = "group"
    """What the sessions of a unit, a unit type or a stand show together."""
    SUMMARY = "summary"
    """How the units of a type drift, or how stands stand."""
    RECOMPUTATION = "recomputation"
    """Of a unit's sessions under another model."""
    JOB = "job"
    """Long work that somebody asked for."""
    MESSAGE = "message"
    """To another program."""


@answer
@dataclass(frozen=True)
class Failed:
    """One piece of background work that has failed."""

    kind: FailedKind
    """What is done."""
    of: str
    """Session, unit, group, job or address."""
    why: str
    """Why it failed, in short; the log says more."""


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
    """What was given up, and how its last try ended where that is known."""
    return say("{failure} The last try: {reason}.", failure=text, reason=without_stop(why)) if why else text


def unit_failed(reason: str) -> str:
    """Of a unit."""
    return say(UNIT, why=without_stop(reason))


def session_failed(reason: str) -> str:
    """Of a session."""
    return say(SESSION, why=without_stop(reason))


def group_failed(reason: str) -> str:
    """Of a unit, a unit type or a stand."""
    return say(GROUP, why=without_stop(reason))
