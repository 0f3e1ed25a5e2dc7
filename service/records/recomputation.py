"""Stored sessions computed again because a model changed: how far it has come, and what moved."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

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


@dataclass(frozen=True)
class MovedVerdict:
    """A session that has another verdict since."""

    session: str
    started_at: datetime
    before: Verdict
    after: Verdict


@dataclass(frozen=True)
class LeftSession:
    """A session that cannot be computed under its model; it keeps what it has."""

    session: str
    why: str


@dataclass(frozen=True)
class MovedParameter:
    """The parameter of a unit that moved furthest, in its own standard uncertainty."""

    session: str
    sensor: str
    kind: str
    parameter: str
    change: float
    """SI; relative of a scale factor, rad of an axis."""
    u: float
    """Standard uncertainty of the parameter."""


@dataclass(frozen=True)
class Recomputed:
    """What became of a unit's sessions."""

    sessions: int
    recomputed: int
    left: int
    """That cannot be calibrated under the model; they keep what they have."""
    verdicts: tuple[MovedVerdict, ...]
    furthest: MovedParameter | None


@dataclass(frozen=True)
class Recomputation:
    """A unit's part of what a revision brought."""

    unit: str
    state: Progress
    done_at: datetime | None
    outcome: Recomputed | None
    """None until it is done."""
    failed: str
    """Why the last try failed; empty where none did."""
