"""Stored sessions computed again because a model changed: how far it has come, and what moved."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.records.answer import answer
from service.records.decision import Verdict


class Progress(StrEnum):
    """How far the sessions of one unit have come."""

    WAITING = "waiting"
    DONE = "done"
    GIVEN_UP = "given up"
    """No process outlived it: the sessions keep what they had."""
    CANCELLED = "cancelled"
    """Somebody stopped it before its turn: the sessions keep what they had."""


@dataclass(frozen=True)
class Task:
    """A unit whose sessions are to be computed again under the models up to a revision."""

    revision: int
    unit: str


@answer
@dataclass(frozen=True)
class MovedVerdict:
    """A session that has another verdict since."""

    session: str
    """Id of the session."""
    started_at: datetime
    """When it was measured."""
    before: Verdict
    """Its verdict before."""
    after: Verdict
    """Its verdict since."""


@dataclass(frozen=True)
class LeftSession:
    """A session that cannot be computed under its model; it keeps what it has."""

    session: str
    why: str


@answer
@dataclass(frozen=True)
class MovedParameter:
    """The parameter of a unit that moved furthest, in its own standard uncertainty."""

    session: str
    """Id of the session."""
    sensor: str
    """Name of the sensor."""
    kind: str
    """`accelerometer` or `gyroscope`."""
    parameter: str
    """`scale`, `bias`, `quadratic`, `axis` or `misalignment`."""
    change: float
    """SI; relative of a scale factor, rad of an axis."""
    u: float
    """Its standard uncertainty."""


@answer
@dataclass(frozen=True)
class Recomputed:
    """What became of a unit's sessions."""

    sessions: int
    """How many it has."""
    recomputed: int
    """How many have another calibration."""
    left: int
    """How many cannot be calibrated under the model, and keep what they have."""
    verdicts: tuple[MovedVerdict, ...]
    """Sessions that have another verdict since."""
    furthest: MovedParameter | None
    """What moved most; null where nothing moved."""


@answer
@dataclass(frozen=True)
class Recomputation:
    """A unit's part of what a revision brought."""

    unit: str
    """Serial number."""
    state: Progress
    """`waiting`, `done`, or `given up`: then its sessions keep what they had."""
    done_at: datetime | None
    """When, UTC; null while it waits."""
    outcome: Recomputed | None
    """What became of its sessions; null until it is done."""
    failed: str
    """Why the last try failed; empty where none did."""
