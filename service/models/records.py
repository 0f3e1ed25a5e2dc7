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
"""Scope of the model by the level of the sessions that show a cause."""


@dataclass(frozen=True)
class NewModel:
    """A cause that an engineer accepts."""

    cause: str
    scope: Scope
    by: str
    note: str


@dataclass(frozen=True)
class NewLasting:
    """A lasting effect that an engineer accepts from the findings in a group."""

    cause: str
    sensors: tuple[str, ...]
    """Sensors of the finding; empty where the cause alone identifies it."""
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
    """Kind of its sensors; empty without any."""
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
    """Functions that the amplitudes of a learned term multiply, in words; empty for a cause."""


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
    """Gain of the finding; None for a group of sessions."""
    pooled: Pooled | None = None
    """Facts from a group; None for a single session: then each session fits the size."""


@answer
@dataclass(frozen=True)
class ModelRevision:
    """One accepted or withdrawn cause: a numbered revision of a model."""

    id: int
    """Number of the revision; all models are numbered through."""
    scope: Scope
    """Scope of the model: a unit, a unit type or a stand."""
    subject: str
    """Serial number of the unit, or name of the unit type or of the stand."""
    cause: str
    """Identifier of the cause."""
    sensors: tuple[str, ...]
    """Sensors that it acts on; none for a cause of stand or fixture."""
    session: str
    """The session that showed it."""
    evidence: AcceptedFinding | None
    """p-value, strength, amplitude with sigma, and gain of the finding; `pooled`: facts from a group of sessions, null
    where a single session showed it.
    """
    accepted_by: str
    """Person who accepted it."""
    note: str
    """Reason for accepting it."""
    accepted_at: datetime
    """Time of acceptance, UTC."""
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
    """Start of the measurement."""
    before: Verdict
    """Verdict before."""
    after: Verdict
    """Verdict since."""


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
    """Standard uncertainty of the parameter."""


@answer
@dataclass(frozen=True)
class Recomputed:
    """Result of a recomputation for a unit's sessions."""

    sessions: int
    """Sessions of the unit."""
    recomputed: int
    """Sessions with another calibration."""
    left: int
    """Sessions that cannot be calibrated under the model, and keep their calibration."""
    verdicts: tuple[MovedVerdict, ...]
    """Sessions that have another verdict since."""
    furthest: MovedParameter | None
    """The parameter that moved most; null where nothing moved."""


@answer
@dataclass(frozen=True)
class Recomputation:
    """A unit's part of what a revision brought."""

    unit: str
    """Serial number."""
    state: Progress
    """`waiting`, `done`, or `given up`: then its sessions keep their calibrations."""
    done_at: datetime | None
    """Time of completion, UTC; null while it waits."""
    outcome: Recomputed | None
    """Result for its sessions; null until it is done."""
    failed: str
    """Reason why the last attempt failed; empty where none did."""
