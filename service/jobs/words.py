"""Long work in words: what it is, how far it has come, and what it did."""

from estimator.wording import counted
from service.jobs.records import KILOBYTE, Job, JobKind, JobState
from service.kit.measures import number
from service.models.records import Scope

AT_FAULT = "The program failed at it, several times: the log says more. It keeps what it had."
FILE_AT_FAULT = (
    "Nothing was stored: the program failed at this file, several times. Upload it again; where it fails again, the "
    "log says why."
)
FLEET_REPORTS = {"xlsx": "Fleet report as a workbook", "pdf": "Fleet report on paper (PDF)"}
WHOLE_FLEET = "All units computed again"
STATES = {
    JobState.WAITING: "Waiting",
    JobState.RUNNING: "At work",
    JobState.DONE: "Done",
    JobState.FAILED: "Failed",
    JobState.CANCELLED: "Cancelled",
}


def title_of(job: Job) -> str:
    """What is done, and to what."""
    if job.kind is JobKind.REPORT:
        return FLEET_REPORTS[job.form]
    if job.kind is JobKind.UPLOAD:
        return f"Upload of {job.subject}"
    if job.kind is JobKind.MODEL:
        return f"Accepted cause, revision {job.revision}: sessions computed again"
    match job.scope:
        case None:
            return WHOLE_FLEET
        case Scope.UNIT:
            return f"Unit {job.subject} computed again"
        case Scope.UNIT_TYPE:
            return f"All units of type {job.subject} computed again"
        case Scope.STAND:
            return f"All units measured on stand {job.subject} computed again"


def left_in_words(left: int) -> str:
    """Why sessions of a unit keep what they had, and what helps."""
    return (
        f"{counted(left, 'session')} left as before: the file is lost, or cannot be calibrated under the model in "
        "force. Upload a lost file again; withdraw an accepted cause that does not fit."
    )


def progress_of(job: Job) -> str:
    """How far it has come."""
    if job.kind is JobKind.UPLOAD:
        return _read_so_far(job)
    if job.kind is JobKind.REPORT:
        return "" if job.state is not JobState.DONE else "The report is made."
    return f"Units: {job.done} of {job.total}"


def _read_so_far(job: Job) -> str:
    """Of a file: megabytes, and how often it was gone through before."""
    if not job.is_open:
        return ""
    if job.is_storing:
        return "It is read; its session is calibrated and is being stored."
    done, total = number(job.done / KILOBYTE, 1), number(job.total / KILOBYTE, 1)
    if not job.cursor:
        return f"Read: {done} of {total} MB."
    times = counted(job.cursor, "time")
    return f"Read again: {done} of {total} MB; all of it was read {times} already. A log takes several."


def outcome_of(job: Job) -> str:
    """What it did so far; empty of a report."""
    if job.kind is JobKind.UPLOAD:
        return _became(job)
    if job.kind is JobKind.REPORT:
        return ""
    if job.state is JobState.DONE and not job.recomputed and not job.failed:
        return "No session needed it: all rest on the models in force already."
    other = f"{counted(job.verdicts, 'session')} with another verdict" if job.verdicts else "no verdict moved"
    return f"{counted(job.recomputed, 'session')} computed again, {other}."


def _became(job: Job) -> str:
    if job.session:
        return "The file is stored as a session."
    return "The file cannot be used. Nothing was stored; correct what is listed and upload it again." * bool(
        job.refusal
    )


def ending_of(job: Job) -> str:
    """What its end means; empty while it goes on."""
    if job.kind is JobKind.UPLOAD:
        return "Cancelled: nothing was stored, and the file is gone." if job.state is JobState.CANCELLED else ""
    match job.state:
        case JobState.CANCELLED:
            return "Cancelled between two pieces: what was done until then stays, the rest keeps what it had."
        case JobState.FAILED:
            return "It could not be done. Ask for it again; where it fails again, the log says why."
        case _:
            return ""
