"""What was done to a unit, and notes on its history."""

from dataclasses import dataclass
from datetime import datetime

from service.records.state import RecordState

SERVICES = ("adjustment", "repair", "sensor-swap", "reference", "service")
"""What can be done to a unit: each is a break, after which the next session is the new reference."""


@dataclass(frozen=True)
class Service:
    """A known break in a unit's history: adjustment, repair, sensor swap, new reference."""

    id: int
    unit: str
    at: datetime
    kind: str
    note: str
    who: str = ""
    sensor: str = ""
    """That it concerns; empty for the whole unit."""
    state: RecordState = RecordState.ACCEPTED
    """One that was withdrawn is no break."""


@dataclass(frozen=True)
class NewService:
    """Something done to a unit that is a known break in its history."""

    kind: str
    """One of `SERVICES`."""
    at: datetime
    note: str = ""
    who: str = ""
    sensor: str = ""
    """That it concerns; empty for the whole unit."""


@dataclass(frozen=True)
class Withdrawal:
    """Why a note no longer holds."""

    at: datetime
    who: str
    why: str


@dataclass(frozen=True)
class Note:
    """A remark on a unit's history at a date."""

    id: int
    unit: str
    at: datetime
    text: str
    who: str
    recorded_at: datetime
    withdrawal: Withdrawal | None
    session: str | None = None
    """That it is about; None for the unit as a whole."""


@dataclass(frozen=True)
class NewAttachment:
    """A file that somebody attached."""

    session: str | None
    """None for the unit as a whole."""
    sha256: str
    filename: str
    """As it was called, printable; only ever shown, never used as a path."""
    size: int
    """Bytes."""
    text: str
    """What it shows."""
    who: str
    at: datetime


@dataclass(frozen=True)
class Attachment(NewAttachment):
    """The same, as it is kept."""

    id: int
    unit: str
    withdrawal: Withdrawal | None
