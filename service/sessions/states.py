"""States of records, sessions and services, since they were received: by whom, when and why."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.kit.answer import Hidden, answer
from service.sessions.doubt import Remedies


class RecordState(StrEnum):
    """State of a record. Only accepted records count for a unit."""

    ACCEPTED = "accepted"
    QUESTIONED = "questioned"
    """The record cannot be as it states, until an engineer confirms it."""
    WITHDRAWN = "withdrawn"
    SUPERSEDED = "superseded"
    """Another record replaces it: a corrected file, one of another unit or of another date."""


class RecordKind(StrEnum):
    """Kinds of record with states."""

    SESSION = "session"
    SERVICE = "service"


@dataclass(frozen=True)
class Step:
    """Person, time and reason of a change of a record."""

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
    """State from then on."""
    who: str
    """Person who changed it; `imu-health` for the service itself."""
    at: datetime
    """Time of the change, UTC."""
    why: str
    """Reason for the change."""
    superseded_by: str | None = None
    """The replacement of a superseded session."""
    remedies: Hidden[Remedies | None] = None
    """Ways to put a questioned record right, as far as known then; None for others, and for lines from before they were
    kept.
    """


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
