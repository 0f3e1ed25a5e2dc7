"""Long work that somebody asked for: how far it has come, what it could not do, and what it made."""

from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum

from pydantic import computed_field

from service.kit.answer import Hidden, answer
from service.models.records import Scope
from service.sessions.sent import Sent

KEPT = timedelta(days=7)
"""That a report stays to be downloaded: a week's leave; it is made anew at any time."""


class JobKind(StrEnum):
    """What is done."""

    RECALIBRATION = "recalibration"
    """Stored sessions computed again under the models in force, unit by unit."""
    MODEL = "model"
    """The sessions that a change of a model concerns, computed again; several processes are at them."""
    REPORT = "report"
    """The fleet's condition as a workbook or on paper."""
    UPLOAD = "upload"
    """A long file that was received whole: read, calibrated, judged and stored."""


class JobState(StrEnum):
    """How far it has come."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


OPEN = (JobState.WAITING, JobState.RUNNING)
"""Nobody has ended it, nor it itself."""


KILOBYTE = 1000
"""Bytes: what has been read of a long file is counted in these."""


@dataclass(frozen=True)
class NewJob:
    """What somebody asks for."""

    kind: JobKind
    who: str
    account: str = ""
    """Login of who asks; empty where nobody signs in."""
    scope: Scope | None = None
    """Whether one unit, one unit type or one stand is meant; None for the whole fleet."""
    subject: str = ""
    """Its name; empty for the whole fleet."""
    form: str = ""
    """Of a report: xlsx or pdf."""
    language: str = ""
    """Of a report."""
    revision: int = 0
    """Of the model that changed."""
    sent: Sent | None = None
    """The file that is taken in; ``subject`` is its name."""


@answer
@dataclass(frozen=True)
class JobFailure:
    """A piece of the work that could not be done."""

    subject: str
    """Serial number of the unit; empty for the whole."""
    reason: str
    """Why, and what helps."""


@dataclass(frozen=True)
class Piece:
    """What became of one piece of a recalibration."""

    recomputed: int = 0
    verdicts: int = 0
    failure: JobFailure | None = None


@answer
@dataclass(frozen=True)
class Made:
    """The file that a job made."""

    filename: str
    """Name for whoever keeps it."""
    size: int
    """Bytes."""
    sha256: str
    """SHA-256 of its content, hexadecimal."""
    until: datetime
    """It is kept until then."""


@answer
@dataclass(frozen=True)
class Job:
    """Long work, as it stands."""

    id: int
    """Number of the job."""
    kind: JobKind
    """What kind of work."""
    scope: Scope | None
    """None for the whole fleet."""
    subject: str
    """Serial number or name; of an upload the file's; empty for the whole fleet."""
    form: Hidden[str]
    language: Hidden[str]
    revision: Hidden[int]
    who: str
    """Who asked for it."""
    account: Hidden[str]
    state: JobState
    """How far it is."""
    asked_at: datetime
    """When it was asked for, UTC."""
    begun_at: datetime | None
    """When it was begun, UTC; none while it waits."""
    ended_at: datetime | None
    """When its last piece was begun, UTC; none while it is not ended."""
    cancelled_by: str
    """Who cancelled it; empty where nobody did."""
    done: int
    """Pieces that are whole: of a recalibration, units; of an upload, kilobytes read."""
    total: int
    """Pieces in all."""
    cursor: Hidden[int]
    """The last piece that is whole, so that whoever takes it up again begins behind it."""
    recomputed: int
    """Sessions that have another calibration since."""
    verdicts: int
    """Sessions that have another verdict since."""
    failed: int
    """Pieces that could not be done."""
    failures: tuple[JobFailure, ...]
    """The first hundred of them."""
    held_up: str
    """Why it waits although it was begun; empty where it does not."""
    made: Made | None
    """What it made, at `/jobs/{id}/file`."""
    sent: Hidden[Sent | None] = None
    """The file that is taken in: of its ``total`` kilobytes ``done`` were read, after ``cursor`` times through all."""
    is_storing: Hidden[bool] = False
    """Whether that file is read and being stored, so that nobody cancels it any more."""
    session: str = ""
    """Of an upload: the session that it became; empty while it is none."""
    refusal: Hidden[int | None] = None
    """Number of its refusal, where it could not be used."""

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def times(self) -> int:
        """Of an upload: how often all of it was read already; a log is read several times."""
        return self.cursor if self.kind is JobKind.UPLOAD else 0

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def upload(self) -> str:
        """Of an upload: its id at `/uploads/{id}`, which tells what becomes of it."""
        return under_way(self.id) if self.kind is JobKind.UPLOAD else ""

    @property
    def is_open(self) -> bool:
        """Whether it is still to be worked on."""
        return self.state in OPEN


UNDER_WAY = "j"
"""Begins the number of an upload that a job still works on."""


def under_way(job: int) -> str:
    """The name of an upload that a job works on."""
    return f"{UNDER_WAY}{job}"
