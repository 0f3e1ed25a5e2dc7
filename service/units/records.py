"""Services, notes and attachments of a unit."""

from dataclasses import dataclass
from datetime import datetime

from service.kit.answer import answer
from service.sessions.states import RecordState, StateChange

SERVICES = ("adjustment", "repair", "sensor-swap", "reference", "service")
"""Services of a unit: each is a break, after which the next session is the new reference."""


@answer
@dataclass(frozen=True)
class Service:
    """A known break in a unit's history."""

    id: int
    """Number of the entry."""
    unit: str
    """Serial number of the unit."""
    at: datetime
    """When it was done, UTC."""
    kind: str
    """What was done."""
    note: str
    """Why, what exactly."""
    who: str = ""
    """Who did it."""
    sensor: str = ""
    """The sensor that it concerns; empty for the whole unit."""
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
    """The sensor concerned; empty for the whole unit."""


@answer
@dataclass(frozen=True)
class Withdrawal:
    """Why a note no longer holds."""

    at: datetime
    """When it was withdrawn, UTC."""
    who: str
    """By whom."""
    why: str
    """Why."""


@answer
@dataclass(frozen=True)
class Note:
    """A remark on a unit's history; never changed."""

    id: int
    """Number of the note."""
    unit: str
    """Serial number of the unit."""
    at: datetime
    """The date it is about, UTC."""
    text: str
    """What is worth knowing."""
    who: str
    """Who said it."""
    recorded_at: datetime
    """When it was written, UTC."""
    withdrawal: Withdrawal | None
    """Why it no longer holds; null while it does."""
    session: str | None = None
    """The session that it is about; null for the unit as a whole."""


@dataclass(frozen=True)
class NewAttachment:
    """A file that somebody attached."""

    session: str | None
    """The session that it is attached to; null for the unit as a whole."""
    sha256: str
    """SHA-256 of the bytes."""
    filename: str
    """What the file was called, printable; only ever shown, never used as a path."""
    size: int
    """Bytes."""
    text: str
    """What it shows."""
    who: str
    """Who attached it."""
    at: datetime
    """When, UTC."""


@answer
@dataclass(frozen=True)
class Attachment(NewAttachment):
    """A file that somebody attached; never changed."""

    id: int
    """Number of the attachment."""
    unit: str
    """Serial number of the unit."""
    withdrawal: Withdrawal | None
    """Why it is given out no more; null while it is."""


@dataclass(frozen=True)
class UnitEvents:
    """Withdrawn ones too."""

    notes: tuple[Note, ...]
    files: tuple[Attachment, ...]
    services: tuple[Service, ...]
    """Of the unit."""
    changes: tuple[StateChange, ...]
    """Changes of state of these services, in order."""

    @property
    def withdrawals(self) -> tuple[StateChange, ...]:
        """The last change of each service that is withdrawn now."""
        withdrawn = {str(s.id) for s in self.services if s.state is RecordState.WITHDRAWN}
        return tuple({change.record: change for change in self.changes if change.record in withdrawn}.values())


NO_EVENTS = UnitEvents((), (), (), ())


@answer
@dataclass(frozen=True)
class Customer:
    """For whom a unit is calibrated, as its certificates name them."""

    name: str = ""
    """Empty where it is not stated."""
    address: str = ""
    """Where they can be reached."""


NO_CUSTOMER = Customer()
"""Of a unit without a customer."""
