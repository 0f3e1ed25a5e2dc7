"""Services, notes and attachments of a unit, and its entry in the register."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.kit.answer import answer
from service.sessions.states import RecordState, StateChange


@answer
@dataclass(frozen=True)
class Service:
    """A known break in a unit's history."""

    id: int
    """Number of the entry."""
    unit: str
    """Serial number of the unit."""
    at: datetime
    """Time of the service, UTC."""
    kind: str
    """Kind of service, such as a repair."""
    note: str
    """Reason and details."""
    who: str = ""
    """Person who did it."""
    sensor: str = ""
    """The sensor that it concerns; empty for the whole unit."""
    state: RecordState = RecordState.ACCEPTED
    """State of the service; a withdrawn one is no break."""


@dataclass(frozen=True)
class NewService:
    """Something done to a unit that is a known break in its history."""

    kind: str
    """`adjustment`, `repair`, `sensor-swap`, `reference` or `service`."""
    at: datetime
    note: str = ""
    who: str = ""
    sensor: str = ""
    """The sensor concerned; empty for the whole unit."""


class ForeseenKind(StrEnum):
    """Kinds of change by a service."""

    VERDICT = "verdict"
    """Verdict of a session."""
    DUE = "next-calibration"
    FLAG = "flag"


@answer
@dataclass(frozen=True)
class ForeseenChange:
    """One change by a service."""

    kind: ForeseenKind
    """`verdict`, `next-calibration` or `flag`."""
    what: str
    """Changed thing in words: the session, the date or the flag."""
    before: str
    """Present state, in words."""
    after: str
    """State after the service, in words."""
    session: str | None = None
    """Id of the session, of a verdict."""


@answer
@dataclass(frozen=True)
class ServicePreview:
    """Changes that a service would bring; nothing is stored."""

    unit: str
    """Serial number of the unit."""
    at: datetime
    """Time of the service, UTC."""
    is_late: bool
    """Whether accepted sessions measured since are stored already."""
    changes: tuple[ForeseenChange, ...]
    """Verdicts in order of time, the next calibration, flags; empty where nothing changes."""


@answer
@dataclass(frozen=True)
class Withdrawal:
    """Withdrawal of a note or file."""

    at: datetime
    """Time of the withdrawal, UTC."""
    who: str
    """Person who withdrew it."""
    why: str
    """Reason for the withdrawal."""


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
    """Text of the note."""
    who: str
    """Person who wrote it."""
    recorded_at: datetime
    """Time of writing, UTC."""
    withdrawal: Withdrawal | None
    """Withdrawal with its reason; null while the note holds."""
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
    """Printable name of the file; only ever shown, never used as a path."""
    size: int
    """Bytes."""
    text: str
    """Description of its contents."""
    who: str
    """Person who attached it."""
    at: datetime
    """Time of attachment, UTC."""


@answer
@dataclass(frozen=True)
class Attachment(NewAttachment):
    """A file that somebody attached; never changed."""

    id: int
    """Number of the attachment."""
    unit: str
    """Serial number of the unit."""
    withdrawal: Withdrawal | None
    """Withdrawal with its reason; null while the file is given out."""


@dataclass(frozen=True)
class UnitEvents:
    """Notes, files and services of a unit or a session, withdrawn ones too."""

    notes: tuple[Note, ...]
    files: tuple[Attachment, ...]
    services: tuple[Service, ...]
    """Services of the unit."""
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
    """Customer for whom a unit is calibrated, as its certificates name them."""

    name: str = ""
    """Name of the customer; empty where it is not stated."""
    address: str = ""
    """Contact address."""


NO_CUSTOMER = Customer()
"""Customer of a unit without one."""


class CustodyStep(StrEnum):
    """Step of a unit in the register."""

    ENTERED = "entered"
    MOVED = "moved"
    """The unit went to another place, or to another custodian."""
    RETIRED = "retired"
    RETURNED = "returned"
    """Put back into use."""


@answer
@dataclass(frozen=True)
class Custody:
    """One change of where a unit is, who has it, or whether it is in use; never changed."""

    id: int
    """Number of the entry."""
    unit: str
    """Serial number of the unit."""
    step: CustodyStep
    """Kind of change: `entered`, `moved`, `retired` or `returned`."""
    at: datetime
    """Time of the change, UTC."""
    who: str
    """Person who recorded it."""
    location_before: str
    """Location before."""
    location: str
    """Location from then on."""
    custodian_before: str
    """Custodian before."""
    custodian: str
    """Custodian from then on."""
    remark: str
    """Reason or remark."""
    recorded_at: datetime
    """Time of writing, UTC."""


@answer
@dataclass(frozen=True)
class Registered:
    """Entry of a unit in the register."""

    unit: str
    """Serial number of the unit."""
    unit_type: str
    """Name of its type."""
    owner: str
    """Owner of the unit; empty where that is not stated."""
    location: str
    """Location of the unit."""
    custodian: str
    """Custodian of the unit."""
    note: str
    """Remark on the unit."""
    registered_at: datetime | None
    """Time of entry, UTC; null for a unit that came with its first session."""
    retired_at: datetime | None
    """Time of retirement, UTC; null while it is in use."""


@dataclass(frozen=True)
class NewEntry:
    """New or changed entry of a unit; None leaves a field as it is."""

    serial: str
    unit_type: str | None = None
    owner: str | None = None
    location: str | None = None
    custodian: str | None = None
    note: str | None = None

    @property
    def stated(self) -> dict[str, str]:
        """The values to be written to the unit itself, by column."""
        known = {"owner": self.owner, "location": self.location, "custodian": self.custodian, "remark": self.note}
        return {name: value for name, value in known.items() if value is not None}


@dataclass(frozen=True)
class Move:
    """Move of a unit to another place or custodian; None leaves it as it is."""

    location: str | None = None
    custodian: str | None = None
    remark: str = ""
    step: CustodyStep = CustodyStep.MOVED
