"""What became of a record, a session or a service, since it was received; by whom, when and why."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.kit.answer import Hidden, answer
from service.sessions.doubt import Remedies


class RecordState(StrEnum):
    """What is known of a unit is derived from its accepted records alone."""

    ACCEPTED = "accepted"
    QUESTIONED = "questioned"
    """It cannot be as it says, until an engineer says that it is."""
    WITHDRAWN = "withdrawn"
    SUPERSEDED = "superseded"
    """It is superseded: by a corrected file, of another unit or of another date."""


class RecordKind(StrEnum):
    """What has states."""

    SESSION = "session"
    SERVICE = "service"


@dataclass(frozen=True)
class Step:
    """By whom, when and why something is done to a record."""

    who: str
    at: datetime
    why: str


@answer
@dataclass(frozen=True)
class StateChange:
    """One line of a record's life."""

    kind: Hidden[RecordKind]
    record: Hidden[str]
    """The session's id, or the service's number."""
    state: RecordState
    """What it is from then on."""
    who: str
    """Who said so; `imu-health` for the service itself."""
    at: datetime
    """When, UTC."""
    why: str
    """Why."""
    superseded_by: str | None = None
    """The replacement of a superseded session."""
    remedies: Hidden[Remedies | None] = None
    """What would put a questioned one right, as far as was known then; None of others, and of lines from before this
    was kept."""


@dataclass(frozen=True)
class ReferenceChoice:
    """An engineer's word that a session is the reference of its epoch; the latest one holds."""

    session: str
    who: str
    at: datetime
    why: str


@dataclass(frozen=True)
class Questioned:
    """A session that waits for an engineer."""

    id: str
    unit: str
    started_at: datetime
