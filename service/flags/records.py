"""Flags, the notices of their changes, and the addresses that are notified."""

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from uuid import NAMESPACE_URL, uuid5

from service.kit.answer import Hidden, answer
from service.models.records import Scope


class Matter(StrEnum):
    """Subject matter of a flag."""

    TOLERANCE = "out-of-tolerance"
    """A sensor is judged fail or conditional fail."""
    CAUSE = "cause"
    """A diagnosis names a cause that acts on a sensor."""
    UNEXPLAINED = "unexplained"
    """A diagnosis finds structure that no known cause explains."""
    STAND = "stand"
    """A diagnosis finds the stand or the fixture at fault."""
    SHIFTED = "stand-shifted"
    """The units measured on a stand show that it has shifted."""
    JUMP = "jump"
    """A parameter of a sensor within tolerance has jumped between two sessions."""
    DRIFT = "drift"
    """A parameter of a sensor within tolerance drifts, ages or moves at no steady rate."""
    LASTING = "lasting"
    """A joint diagnosis of the sessions of a unit, a unit type or a stand has findings."""
    OVERDUE = "overdue"
    """The unit's calibration is overdue."""


AT_FAULT = (Matter.STAND, Matter.SHIFTED)
"""Matters of flags on units that find a stand at fault; their place is its name."""


class FlagState(StrEnum):
    """State of a flag."""

    RAISED = "raised"
    ACKNOWLEDGED = "acknowledged"
    RESOLVED = "resolved"


class NoticeKind(StrEnum):
    """Kind of event."""

    RAISED = "flag.raised"
    SEEN = "flag.seen"
    """A later session shows the matter of an open flag again."""
    CLEAR = "flag.clear"
    """A later session no longer shows it: somebody may resolve the flag."""
    ACKNOWLEDGED = "flag.acknowledged"
    ASSIGNED = "flag.assigned"
    """The flag has another assignee, or none any more."""
    RESOLVED = "flag.resolved"
    VERDICT = "verdict.changed"


@dataclass(frozen=True)
class Assignee:
    """Person assigned to flags."""

    name: str
    """Name on flags; empty for nobody."""
    login: str = ""
    """Account; empty where there are none."""


NOBODY = Assignee("")


@dataclass(frozen=True)
class Concern:
    """A reason to have an open flag."""

    matter: Matter
    place: str
    """The sensor or the stand that it is about; empty for the unit as a whole."""
    severity: int
    """Severity among concerns of one matter: a larger one is worse."""
    summary: str
    scope: Scope = Scope.UNIT
    """Whether it is about the unit, or about its whole type or a stand, which the unit only showed last."""
    subject: str = ""
    """Name of the type or the stand."""
    causes: tuple[str, ...] = ()
    """Causes by which a diagnosis explains it, each equally possible; empty for any other concern."""
    sensors: tuple[tuple[str, str], ...] = ()
    """Names and kinds of the sensors on which they act; empty for a cause of the stand."""

    @property
    def key(self) -> tuple[str, str]:
        """Matter and place, for which only one flag is open."""
        return self.matter, self.place


@answer
@dataclass(frozen=True)
class Notice:
    """One change of a flag."""

    id: Hidden[int]
    unit: Hidden[str]
    flag: Hidden[int | None]
    kind: NoticeKind
    """Kind of event."""
    at: datetime
    """Time of the event, UTC."""
    who: str
    """Person who did it; `imu-health` for the service itself."""
    text: str
    """Observation, or reason for the action."""
    session: str | None
    """The session that it follows from, if one does."""

    @property
    def key(self) -> str:
        """Key of the notice, the same wherever and whenever it is sent: by it a receiver recognises a repeat."""
        return str(uuid5(NAMESPACE_URL, f"imu-health/{self.unit}/{self.at.isoformat()}/{self.id}"))


@answer
@dataclass(frozen=True)
class Flag:
    """A matter that somebody must look after."""

    id: int
    """Number of the flag."""
    unit: str
    """Serial number of the unit; of another scope, of the unit that showed it last."""
    matter: Matter
    """Matter of the flag."""
    place: str
    """The sensor or the stand that it is about; empty for the unit as a whole."""
    state: FlagState
    """`raised`, `acknowledged` or `resolved`."""
    severity: Hidden[int]
    summary: str
    """The matter as the latest session shows it, in a sentence or two."""
    proposal: str
    """Reason why it could be resolved; empty while there is none."""
    session: str | None
    """The latest session that showed it."""
    raised_at: datetime
    """Time at which it was first raised, UTC."""
    changed_at: datetime
    """Time of the last change, UTC."""
    assignee: str = ""
    """Person assigned to it; empty where nobody in particular is."""
    scope: Scope = Scope.UNIT
    """Whether it is about the unit, its whole unit type or a stand."""
    subject: str = ""
    """Name of the unit type or the stand; empty where it is about the unit."""
    changes: tuple[Notice, ...] = ()
    """Changes of the flag, oldest first; they are never altered."""

    @property
    def key(self) -> tuple[str, str]:
        """Matter and place, for which only one flag is open."""
        return self.matter, self.place


@answer
@dataclass(frozen=True)
class Webhook:
    """An address that is notified."""

    id: int
    """Number of the webhook."""
    url: str
    """Address to which messages are sent."""
    secret: Hidden[str] = field(repr=False)
    who: str
    """Person who registered it."""
    created_at: datetime
    """Time of registration, UTC."""


class DeliveryState(StrEnum):
    """Progress of a delivery."""

    WAITING = "waiting"
    DELIVERED = "delivered"
    FAILED = "failed"
    """Given up."""


@answer
@dataclass(frozen=True)
class Delivery:
    """One message to one address."""

    id: int
    """Number of the delivery."""
    notice: Notice
    """Notice that the address is sent."""
    state: DeliveryState
    """`waiting`, `delivered`, or `failed`: given up."""
    attempts: int
    """Number of attempts."""
    next_at: datetime
    """Time of the next attempt, UTC; for an ended delivery, its end."""
    outcome: str
    """Result of the latest attempt."""


@dataclass(frozen=True)
class Outgoing:
    """A delivery that is to be attempted now."""

    delivery: int
    attempt: int
    """Number of the attempt, from 1."""
    webhook: Webhook
    notice: Notice
    matter: Matter | None
    """Matter of the notice's flag; None where it is about no flag."""
    place: str
