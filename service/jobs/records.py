"""Long jobs: progress, failures and results."""

from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum

from pydantic import computed_field

from service.kit.answer import Hidden, answer
from service.models.records import Scope
from service.sessions.sent import Sent

KEPT = timedelta(days=7)
"""Retention of a report: a week's leave; it can be made again at any time."""


class JobKind(StrEnum):
    """Kinds of long work."""

    RECALIBRATION = "recalibration"
    """Stored sessions computed again under the models in force, unit by unit."""
    MODEL = "model"
    """The sessions concerned by a change of a model, computed again by several processes."""
    REPORT = "report"
    """The fleet's condition as a workbook or on paper."""
    UPLOAD = "upload"
    """A long file that was received completely: read, calibrated, judged and stored."""


class JobState(StrEnum):
    """State of a job."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


OPEN = (JobState.WAITING, JobState.RUNNING)
"""States of a job that is neither ended nor cancelled."""


KILOBYTE = 1000
"""Bytes per unit of progress of a long file."""


@dataclass(frozen=True)
class NewJob:
    """A requested job."""

    kind: JobKind
    who: str
    account: str = ""
    """Login of the requester; empty where there are no accounts."""
    scope: Scope | None = None
    """One unit, one unit type or one stand; None for the whole fleet."""
    subject: str = ""
    """Name of the unit, unit type or stand; empty for the whole fleet."""
    form: str = ""
    """Form of a report: xlsx or pdf."""
    language: str = ""
    """Language of a report."""
    revision: int = 0
    """Revision of the changed model."""
    sent: Sent | None = None
    """The uploaded file; ``subject`` is its name."""


@answer
@dataclass(frozen=True)
class JobFailure:
    """A piece of the work that could not be done."""

    subject: str
    """Serial number of the unit; empty for the whole."""
    reason: str
    """Reason for the failure, and the remedy."""


@dataclass(frozen=True)
class RecalibrationPiece:
    """Result of one piece of a recalibration."""

    recomputed: int = 0
    verdicts: int = 0
    failure: JobFailure | None = None


@answer
@dataclass(frozen=True)
class Made:
    """The file that a job made."""

    filename: str
    """Name for saving it."""
    size: int
    """Bytes."""
    sha256: str
    """SHA-256 of its content, hexadecimal."""
    until: datetime
    """Time until which it is kept, UTC."""


@answer
@dataclass(frozen=True)
class Job:
    """Long work, as it stands."""

    id: int
    """Number of the job."""
    kind: JobKind
    """Kind of work."""
    scope: Scope | None
    """Scope of the work; None for the whole fleet."""
    subject: str
    """Serial number or name; of an upload the file's; empty for the whole fleet."""
    form: Hidden[str]
    language: Hidden[str]
    revision: Hidden[int]
    who: str
    """Person who asked for it."""
    account: Hidden[str]
    state: JobState
    """Progress of the job."""
    asked_at: datetime
    """Time of the request, UTC."""
    begun_at: datetime | None
    """Start, UTC; none while it waits."""
    ended_at: datetime | None
    """Start of its last piece, UTC; none while it is not ended."""
    cancelled_by: str
    """Person who cancelled it; empty where nobody did."""
    done: int
    """Pieces that are whole: of a recalibration, units; of an upload, kilobytes read."""
    total: int
    """Pieces in all."""
    cursor: Hidden[int]
    """Last finished piece, after which work resumes."""
    recomputed: int
    """Sessions that have another calibration since."""
    verdicts: int
    """Sessions that have another verdict since."""
    failed: int
    """Pieces that could not be done."""
    failures: tuple[JobFailure, ...]
    """Pieces that failed, the first hundred of them."""
    held_up: str
    """Reason why it waits although it was begun; empty where it does not."""
    made: Made | None
    """The file that it made, at `/jobs/{id}/file`."""
    sent: Hidden[Sent | None] = None
    """The uploaded file: ``done`` of its ``total`` kilobytes were read in this pass, after ``cursor`` passes."""
    is_storing: Hidden[bool] = False
    """Whether that file is being stored and can no longer be cancelled."""
    session: str = ""
    """Id of the session that an upload became; empty while it is none."""
    refusal: Hidden[int | None] = None
    """Number of its refusal, where it could not be used."""

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def times(self) -> int:
        """Number of times that all of an upload was read already; a log is read several times."""
        return self.cursor if self.kind is JobKind.UPLOAD else 0

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def upload(self) -> str:
        """Id of an upload at `/uploads/{id}`, which gives its outcome."""
        return under_way(self.id) if self.kind is JobKind.UPLOAD else ""

    @property
    def is_open(self) -> bool:
        """Whether it is still to be worked on."""
        return self.state in OPEN


UNDER_WAY = "j"
"""Prefix of the identifier of an upload that is still a job."""


def under_way(job: int) -> str:
    """Identifier of an upload that is still a job."""
    return f"{UNDER_WAY}{job}"
