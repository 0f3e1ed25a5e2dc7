"""Long jobs in words: title, progress and outcome."""

from estimator.message import say
from estimator.wording import counted
from service.jobs.records import KILOBYTE, Job, JobKind, JobState
from service.kit.measures import number
from service.models.records import Scope

AT_FAULT = "The program failed several times: see the log. Nothing was changed."
FILE_AT_FAULT = (
    "Nothing was stored: the program failed several times on this file. Upload it again; if it fails again, see the "
    "log."
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
    """The kind of work and its subject."""
    if job.kind is JobKind.REPORT:
        return FLEET_REPORTS[job.form]
    if job.kind is JobKind.UPLOAD:
        return say("Upload of {subject}", subject=job.subject)
    if job.kind is JobKind.MODEL:
        return say("Accepted cause, revision {revision}: sessions computed again", revision=job.revision)
    match job.scope:
        case None:
            return WHOLE_FLEET
        case Scope.UNIT:
            return say("Unit {subject} computed again", subject=job.subject)
        case Scope.UNIT_TYPE:
            return say("All units of type {subject} computed again", subject=job.subject)
        case Scope.STAND:
            return say("All units measured on stand {subject} computed again", subject=job.subject)


def left_in_words(count: int) -> str:
    """The reason why sessions of a unit were left as before, and the remedy."""
    return say(
        "{sessions} left as before: the file is lost, or cannot be calibrated under the model in "
        "force. Upload a lost file again; withdraw an accepted cause that does not fit.",
        sessions=counted(count, "session"),
    )


def progress_of(job: Job) -> str:
    """Progress in words."""
    if job.kind is JobKind.UPLOAD:
        return _upload_progress(job)
    if job.kind is JobKind.REPORT:
        return "" if job.state is not JobState.DONE else "The report is made."
    return say("Units: {done} of {total}", done=job.done, total=job.total)


def _upload_progress(job: Job) -> str:
    """Progress of an upload: megabytes, and finished passes."""
    if not job.is_open:
        return ""
    if job.is_storing:
        return "It is read; its session is calibrated and is being stored."
    done, total = number(job.done / KILOBYTE, 1), number(job.total / KILOBYTE, 1)
    if not job.cursor:
        return say("Read: {done} of {total} MB.", done=done, total=total)
    times = counted(job.cursor, "time")
    parts = {"done": done, "total": total, "times": times}
    return say("Read again: {done} of {total} MB; all of it was read {times} already. A log takes several.", **parts)


def outcome_of(job: Job) -> str:
    """Result so far; empty for a report."""
    if job.kind is JobKind.UPLOAD:
        return _upload_outcome(job)
    if job.kind is JobKind.REPORT:
        return ""
    if job.state is JobState.DONE and not job.recomputed and not job.failed:
        return "No session needed it: all use the models in force."
    verdicts = (
        say("{verdicts} with another verdict", verdicts=counted(job.verdicts, "session"))
        if job.verdicts
        else "no verdict changed"
    )
    return say(
        "{recomputed} computed again, {verdicts}.", recomputed=counted(job.recomputed, "session"), verdicts=verdicts
    )


def _upload_outcome(job: Job) -> str:
    if job.session:
        return "The file is stored as a session."
    return "The file cannot be used. Nothing was stored; correct what is listed and upload it again." * bool(
        job.refusal
    )


def ending_of(job: Job) -> str:
    """The consequence of the job's end; empty while it is open."""
    if job.kind is JobKind.UPLOAD:
        return "Cancelled: nothing was stored, and the file is gone." if job.state is JobState.CANCELLED else ""
    match job.state:
        case JobState.CANCELLED:
            return "Cancelled between two pieces: what was done until then stays, the rest keeps what it had."
        case JobState.FAILED:
            return "The job failed. Request it again; if it fails again, see the log."
        case _:
            return ""
