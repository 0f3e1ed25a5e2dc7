"""Accepted causes, the model composed of them, and the results of recomputation."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from estimator.codec import MOMENT, Document
from estimator.diagnosis.results import Gain
from estimator.groups.fixed import FixedEffect
from service.kit.answer import answer
from service.sessions.decision import Verdict


class Scope(StrEnum):
    """Subject of a model with accepted causes."""

    UNIT = "unit"
    UNIT_TYPE = "unit type"
    STAND = "stand"


SCOPES = {"unit": Scope.UNIT, "type": Scope.UNIT_TYPE, "stand": Scope.STAND}
"""By the level of the sessions that show a cause."""


@dataclass(frozen=True)
class NewModel:
    """A cause that an engineer accepts."""

    cause: str
    scope: Scope
    by: str
    note: str
    again: bool = False
    """Whether the stored sessions that it concerns are computed again."""


@dataclass(frozen=True)
class NewLasting:
    """A lasting effect that an engineer accepts from the findings in a group."""

    cause: str
    sensors: tuple[str, ...]
    """Of the finding; empty where the cause alone identifies it."""
    by: str
    note: str


@dataclass(frozen=True)
class Pooled(Document, forms=dict.fromkeys(("first", "last", "since"), MOMENT)):
    """Facts of an effect in a group of sessions beside its size, which is then fixed in every session."""

    sessions: int
    """Number of pooled sessions, from ``first`` to ``last``."""
    first: str | None
    last: str | None
    form: str
    """``same``, ``varying`` or ``since``."""
    since: str | None
    """Start of the first session with the effect, where earlier ones lack it."""
    kind: str
    """Of its sensors; empty without any."""
    shape: float | None
    spread: tuple[float, ...]
    """τ of each sensor in turn, in the unit of its amplitudes."""
    e_value: float
    fitted: int
    """Sessions that fixed the size when it was tried on the later ones; 0 where there were too few."""
    held_out: int
    log_score: float | None
    """Gain of those later ones."""
    words: tuple[str, ...] = ()
    """Of a learned term: what each amplitude multiplies; empty for a cause."""


@dataclass(frozen=True)
class AcceptedFinding:
    """The finding on which a cause was accepted, and its gain."""

    p_value: float
    strength: float
    amplitude: tuple[float, ...]
    """SI, with ``sigma`` and ``units``; empty where the cause was an equal alternative of the named one."""
    sigma: tuple[float, ...]
    units: tuple[str, ...]
    nonlinear: dict[str, float]
    alternatives: tuple[str, ...]
    sentence: str
    gain: Gain | None
    """None for a group of sessions."""
    pooled: Pooled | None = None
    """None for a single session: then each session fits the size."""


@answer
@dataclass(frozen=True)
class ModelRevision:
    """One accepted or withdrawn cause: a numbered revision of a model."""

    id: int
    """Number of the revision; all models are numbered through."""
    scope: Scope
    """Whose model it is."""
    subject: str
    """Serial number of the unit, or name of the unit type or of the stand."""
    cause: str
    """Identifier of the cause."""
    sensors: tuple[str, ...]
    """Sensors that it acts on; none for a cause of stand or fixture."""
    session: str
    """The session that showed it."""
    evidence: AcceptedFinding | None
    """p-value, strength, amplitude with sigma, and gain of the finding; `pooled`: what a group of sessions adds,
    null where a single session showed it."""
    accepted_by: str
    """Who accepted it."""
    note: str
    """Why."""
    accepted_at: datetime
    """When, UTC."""
    withdraws: int | None = None
    """The revision that this one withdraws; null for an accepted cause."""


@dataclass(frozen=True)
class Model:
    """The causes beyond the baseline in a session's calibration."""

    revision: int
    """The latest revision that concerns the session; 0 for the baseline alone."""
    causes: tuple[tuple[str, tuple[str, ...]], ...]
    """Identifier and sensors of each fitted cause."""
    fixed: tuple[FixedEffect, ...] = ()
    """Effects with a size fixed by groups of sessions; the first one applies before others of its cause."""


class Progress(StrEnum):
    """State of the recomputation of one unit."""

    WAITING = "waiting"
    DONE = "done"
    GIVEN_UP = "given up"
    """No process survived it: the sessions stay as they were."""
    CANCELLED = "cancelled"
    """Cancelled before it began: the sessions stay as they were."""


@dataclass(frozen=True)
class Task:
    """Recomputation of a unit's sessions under the models up to a revision."""

    revision: int
    unit: str

    @property
    def key(self) -> str:
        """Key in the queue."""
        return f"{self.unit} {self.revision}"


def task_of(key: str) -> Task:
    """The task of a key."""
    unit, _, revision = key.rpartition(" ")
    return Task(int(revision), unit)


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
    """A session that cannot be computed under its model; it stays as it was."""

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
