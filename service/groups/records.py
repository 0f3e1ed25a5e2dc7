"""Sessions that are looked at together: of a unit, a unit type or a stand."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from estimator.codec import MOMENT, Document, Form
from estimator.groups.results import EmpiricalTerm, GroupFinding, GroupGain, PoolLimit
from estimator.message import say, with_messages


class Level(StrEnum):
    """Kind of group: the sessions of a unit, of a unit type or on a stand."""

    UNIT = "unit"
    TYPE = "type"
    STAND = "stand"


@dataclass(frozen=True)
class Group:
    """A unit, a unit type or a stand."""

    level: Level
    key: int
    name: str

    @property
    def place(self) -> str:
        """Name of the group in the queue of work."""
        return f"{self.level} {self.key}"


@dataclass(frozen=True)
class Member:
    """A session of a group."""

    session: str
    started_at: datetime
    sha256: str
    filename: str
    unit: str
    unit_type: str
    stand: str | None
    has_statistics: bool
    why: str
    """Reason why it has none; empty where it is not known yet."""


@dataclass(frozen=True)
class Members:
    """The sessions that a group's answer rests on."""

    sessions: tuple[Member, ...]
    """Sessions, oldest first."""
    left_out: int
    """Older ones, beyond the most that are pooled."""

    @property
    def pooled(self) -> tuple[Member, ...]:
        """Sessions with statistics."""
        return tuple(m for m in self.sessions if m.has_statistics)

    @property
    def without(self) -> tuple[Member, ...]:
        """Sessions without statistics."""
        return tuple(m for m in self.sessions if not m.has_statistics)


@dataclass(frozen=True)
class GroupAnswer:
    """Stored joint diagnosis of a group's sessions."""

    rests_on: str
    """Digest of its sessions."""
    sessions: int
    summary: str
    own: str
    """Findings that belong to the group itself, neither to one of its units nor to a stand; empty for none."""
    document: str | None
    """imu-fleet-diagnosis/1 with what the service adds; None where it could not be made."""
    estimator_version: str
    created_at: datetime

    def is_of_another(self, version: str) -> bool:
        """Whether a version of the program failed at it that is not this one."""
        return self.document is None and self.estimator_version != version


@dataclass(frozen=True)
class FoundTogether:
    """A group whose sessions show something that is its own, in a line."""

    group: Group
    own: str


STRUCTURES = Form(
    list,
    lambda listed: tuple(
        say("{place} ({subject})", place=with_messages(f["where"]), subject=f["subject"]) for f in listed
    ),
)
"""Read from what the estimator found; never written."""


@dataclass(frozen=True)
class GroupShown(Document, forms={"first": MOMENT, "last": MOMENT, "structures": STRUCTURES}):
    """Contents of imu-fleet-diagnosis/1 for pages."""

    sessions: int
    first: str | None
    last: str | None
    left_out: int
    findings: tuple[GroupFinding, ...]
    limits: tuple[PoolLimit, ...]
    gain: GroupGain | None
    terms: tuple[EmpiricalTerm, ...]
    structures: tuple[str, ...]
    """Places of structure in the residuals that no cause explains."""
    notes: tuple[str, ...]
