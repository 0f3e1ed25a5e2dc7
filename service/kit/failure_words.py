"""Work beside the requests that has failed, in words: what, why, and who must act."""

from estimator.message import say, without_stop
from service.kit.failure import FailedKind

UNIT = (
    "Its dates and verdicts could not be worked out with its latest records: {why}. The administrator must act: see "
    "Failed work on the page Jobs, and the log."
)
SESSION = "Its diagnosis failed: {why}. The administrator must act: see Failed work on the page Jobs, and the log."
GROUP = (
    "What these sessions show together could not be worked out: {why}. The administrator must act: see Failed work on "
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
    return say("{text} The last try: {why}.", text=text, why=without_stop(why)) if why else text


def unit_failed(reason: str) -> str:
    """Of a unit."""
    return say(UNIT, why=without_stop(reason))


def session_failed(reason: str) -> str:
    """Of a session."""
    return say(SESSION, why=without_stop(reason))


def group_failed(reason: str) -> str:
    """Of a unit, a unit type or a stand."""
    return say(GROUP, why=without_stop(reason))
