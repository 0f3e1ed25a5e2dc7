"""Work beside the requests that waits in the queue."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum


class WorkKind(StrEnum):
    """What is done, under the same names as in `FailedKind`."""

    DIAGNOSIS = "diagnosis"
    """Of a session, by its identifier."""
    OUTLOOK = "outlook"
    """Of a unit, by its serial number."""
    DERIVATION = "derivation"
    """Verdicts of a unit after a change of its records: only failures are kept, by serial number."""
    GROUP = "group"
    """What the sessions of a unit, a unit type or a stand show together, by `Group.place`."""
    SUMMARY = "summary"
    """How the units of a type drift, or how stands stand, by `Group.place`."""
    RECOMPUTATION = "recomputation"
    """A unit's sessions under another model, by `Task.key`."""
    JOB = "job"
    """A piece of long work that somebody asked for, by the number of its job."""
    UPLOAD = "upload"
    """A long file that was received whole, by the number of its job."""
    MESSAGE = "message"
    """To a webhook, by the number of its delivery."""


class WorkState(StrEnum):
    """Whether it is still tried."""

    WAITING = "waiting"
    FAILED = "failed"
    """Given up: tried again when somebody asks for it anew."""


@dataclass(frozen=True)
class Waiting:
    """A piece of work that is still to be done."""

    ticket: str
    """Another one whenever what the work looks at changes: what was made under an older one is not stored."""
    not_before: datetime | None
    """After a try that failed, until the next one; None where there was none."""
    failed: str
    """Why the last try failed; empty where none did."""
