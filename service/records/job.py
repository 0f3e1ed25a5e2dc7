"""Long work that somebody asked for: how far it has come, what it could not do, and what it made."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum
from typing import Any

from service.records.model import Scope
from service.records.received import Replaced

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
class Sent:
    """A file that was received whole and is still to be read, with what its sender said of it."""

    place: str
    """Its name among those that wait."""
    sha256: str
    size: int
    """Bytes."""
    account: str = ""
    """As the audit trail names who sent it."""
    is_check: bool = False
    replaces: Replaced | None = None
    mapping: Mapping[str, Any] | None = None
    """How a table of one's own layout is read."""


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


@dataclass(frozen=True)
class JobFailure:
    """A piece of the work that could not be done, and did not stop the others."""

    subject: str
    reason: str


@dataclass(frozen=True)
class Piece:
    """What became of one piece of a recalibration."""

    recomputed: int = 0
    verdicts: int = 0
    failure: JobFailure | None = None


@dataclass(frozen=True)
class Made:
    """The file that a job made."""

    filename: str
    size: int
    sha256: str
    until: datetime
    """It is kept until then."""


@dataclass(frozen=True)
class Job:
    """Long work, as it stands."""

    id: int
    kind: JobKind
    scope: Scope | None
    subject: str
    form: str
    language: str
    revision: int
    who: str
    account: str
    state: JobState
    asked_at: datetime
    begun_at: datetime | None
    ended_at: datetime | None
    cancelled_by: str
    done: int
    """Pieces that are whole."""
    total: int
    cursor: int
    """The last piece that is whole, so that whoever takes it up again begins behind it."""
    recomputed: int
    """Sessions that have another calibration since."""
    verdicts: int
    """Sessions that have another verdict since."""
    failed: int
    """Pieces that could not be done."""
    failures: tuple[JobFailure, ...]
    """The first of them."""
    held_up: str
    """Why it waits although it was begun; empty where it does not."""
    made: Made | None
    sent: Sent | None = None
    """The file that is taken in: of its ``total`` kilobytes ``done`` were read, after ``cursor`` times through all."""
    is_storing: bool = False
    """Whether that file is read and being stored, so that nobody cancels it any more."""
    session: str = ""
    """That it became; empty where it became none."""
    refusal: int | None = None
    """Number of its refusal, where it could not be used."""

    @property
    def is_open(self) -> bool:
        """Whether it is still to be worked on."""
        return self.state in OPEN
