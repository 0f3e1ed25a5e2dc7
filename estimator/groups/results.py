"""What a group's sessions show together; no algorithms. The JSON form is ``imu-fleet-diagnosis/1``."""

from dataclasses import asdict, dataclass
from typing import Any

from estimator.diagnosis.results import Limit


@dataclass(frozen=True)
class SessionAmplitude:
    """One line of a forest plot."""

    started_at: str | None
    """In UTC; None where the file states none."""
    unit: str
    amplitude: tuple[float, ...]
    """SI, element by element as in the finding."""
    sigma: tuple[float | None, ...]
    """None where the session does not see the element."""


@dataclass(frozen=True)
class Rival:
    """An explanation that the group does not tell from the named one, and what would."""

    cause: str
    sensors: tuple[str, ...]
    level: str
    subject: str
    probability: float
    """Share among all explanations, given that one of them acts."""
    separation: float
    """Standard errors of a reading, on the pool."""
    measurement: str
    """What to measure, in words; empty where nothing that the planner knows would tell."""
    sessions: int | None
    """How many such sessions would tell them apart; None where none would."""


@dataclass(frozen=True)
class GroupFinding:
    """One lasting effect."""

    cause: str
    level: str
    """``unit``, ``type`` or ``stand``: whose it is."""
    subject: str
    """Serial of the unit, name of the type, id of the stand."""
    sensors: tuple[str, ...]
    """``*`` for every sensor of a kind; none for a cause of stand or fixture."""
    kind: str
    """Of the sensors; empty without any."""
    amplitude: tuple[float, ...]
    sigma: tuple[float | None, ...]
    """None of an amplitude that the pool does not see."""
    units: tuple[str, ...]
    spread: tuple[float, ...]
    """τ of each sensor in turn, in the unit of its amplitudes."""
    shape: float | None
    """Time constant, s, on the common grid; None where the cause has none."""
    form: str
    """``same``: always there; ``varying``: there, but different every time; ``since``: from a session on."""
    since: str | None
    """Start of the first session that has it, where earlier ones had not; None too where that states none."""
    e_value: float
    strength: float
    """Pooled, in standard errors of a reading."""
    cochran: float
    """p-value that one amplitude differs so much between sessions by noise."""
    alternatives: tuple[str, ...]
    rivals: tuple[Rival, ...]
    sentence: str
    advice: str
    sessions: tuple[SessionAmplitude, ...]
    picture: dict[str, Any] | None = None
    """Pooled residual of one sensor against what the effect depends on, without and with it; None without sessions."""

    def to_dict(self) -> dict[str, Any]:
        found = asdict(self)
        for name in ("sensors", "amplitude", "sigma", "units", "spread", "alternatives"):
            found[name] = list(found[name])
        found["rivals"] = [asdict(r) | {"sensors": list(r.sensors)} for r in self.rivals]
        found["sessions"] = [
            asdict(s) | {"amplitude": list(s.amplitude), "sigma": list(s.sigma)} for s in self.sessions
        ]
        return found


@dataclass(frozen=True)
class GroupStructure:
    """Structure that all sessions share and no cause explains."""

    where: str
    subject: str
    sensors: tuple[str, ...]
    strength: float

    def to_dict(self) -> dict[str, Any]:
        return asdict(self) | {"sensors": list(self.sensors)}


@dataclass(frozen=True)
class PoolLimit:
    """What the pool would have found with 95 % power, and what its latest session would."""

    pool: Limit
    session: Limit

    def to_dict(self) -> dict[str, Any]:
        return self.pool.to_dict() | {"one_session": self.session.to_dict()["amplitude"]}


@dataclass(frozen=True)
class Moved:
    """Largest change of the parameters of a session because the findings are modelled, in their own sigma."""

    parameter: str
    sensor: str
    change: float
    """SI."""
    sigmas: float


@dataclass(frozen=True)
class GroupGain:
    """Prediction of sessions that took no part in the fit, without and with the findings."""

    fitted: int
    """Sessions that fixed the amplitudes."""
    held_out: int
    """Later ones that they were tried on."""
    log_score: float
    """Gained log predictive density over all of them."""
    chi2_per_dof_before: float
    chi2_per_dof_after: float
    moved: tuple[Moved, ...]

    def to_dict(self) -> dict[str, Any]:
        return asdict(self) | {"moved": [asdict(m) for m in self.moved]}


@dataclass(frozen=True)
class EmpiricalTerm:
    """A term that was learned from the sessions: it describes, and names no physical cause."""

    equation: str
    """With units."""
    words: tuple[str, ...]
    """What each amplitude multiplies: ``sin 3β``; of the applied vector with the angle it turns, ``δβ: sin 3β``."""
    sensors: tuple[str, ...]
    """None where it acts on the applied vector."""
    subject: str
    amplitude: tuple[float, ...]
    sigma: tuple[float, ...]
    units: tuple[str, ...]
    gain: float
    """Log predictive density gained on the sessions that took no part in the fit."""
    explained: float
    """Share of the excess χ² of those sessions that it removes."""
    nearest: str
    """Catalogue cause that comes nearest."""
    separation: float
    """From it, on the pool, standard errors of a reading."""
    picture: dict[str, Any]
    """Pooled residual against its variable, before and after."""
    level: str = ""
    """``unit``, ``type`` or ``stand``: whose it is."""

    def to_dict(self) -> dict[str, Any]:
        found = asdict(self)
        for name in ("words", "sensors", "amplitude", "sigma", "units"):
            found[name] = list(found[name])
        return found


@dataclass(frozen=True)
class GroupDiagnosis:
    """What a group's sessions show together."""

    level: str
    subject: str
    sessions: int
    first: str | None
    """Start of the oldest session; None where it states none."""
    last: str | None
    """The same of the latest."""
    findings: tuple[GroupFinding, ...]
    terms: tuple[EmpiricalTerm, ...]
    structures: tuple[GroupStructure, ...]
    limits: tuple[PoolLimit, ...]
    gain: GroupGain | None
    """None without findings, or with too few sessions to leave any out."""
    e_value: float
    """Against nothing beside the findings."""
    notes: tuple[str, ...] = ()

    @property
    def unexplained(self) -> bool:
        """Whether sessions share structure that no cause explains."""
        return bool(self.structures)

    def to_dict(self) -> dict[str, Any]:
        """``imu-fleet-diagnosis/1``."""
        return {
            "format": "imu-fleet-diagnosis/1",
            "level": self.level,
            "id": self.subject,
            "sessions": self.sessions,
            "first": self.first,
            "last": self.last,
            "findings": [f.to_dict() for f in self.findings],
            "terms": [t.to_dict() for t in self.terms],
            "unexplained": self.unexplained,
            "structures": [s.to_dict() for s in self.structures],
            "limits": [limit.to_dict() for limit in self.limits],
            "gain": None if self.gain is None else self.gain.to_dict(),
            "e_value": self.e_value,
            "notes": list(self.notes),
        }
