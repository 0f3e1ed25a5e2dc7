"""Results of the diagnosis of a group; no algorithms. The JSON form is ``imu-fleet-diagnosis/1``."""

from dataclasses import dataclass

from estimator.codec import MOMENT, Document
from estimator.diagnosis.results import Limit


@dataclass(frozen=True)
class SessionAmplitude(Document, forms={"started_at": MOMENT}):
    """One line of a forest plot."""

    started_at: str | None
    """Start in UTC; None where the file states none."""
    unit: str
    amplitude: tuple[float, ...]
    """SI, element by element as in the finding."""
    sigma: tuple[float | None, ...]
    """One sigma of each amplitude; None where the session does not see the element."""


@dataclass(frozen=True)
class GroupRival:
    """An explanation that the group cannot tell from the named one, and the measurement that would."""

    cause: str
    sensors: tuple[str, ...]
    level: str
    subject: str
    probability: float
    """Share among all explanations, given that one of them acts."""
    separation: float
    """Standard errors of a reading, on the pool."""
    measurement: str
    """Measurement to make, in words; empty where nothing that the planner knows would do."""
    sessions: int | None
    """Number of such sessions that would tell them apart; None where none would."""


@dataclass(frozen=True)
class Picture:
    """Mean residual of each of N bins of a variable, without an effect and with it. Of a sensor, m/s² (rad/s), or of an
    angle of the head, rad."""

    variable: str
    """``β``, ``(T − T̄)``, ``(t − t̄)`` or ``a``."""
    at: tuple[float, ...]
    """(N,) rad, K, s, or the input as a part of the applied vector."""
    before: tuple[float, ...]
    """(N,)"""
    after: tuple[float, ...]
    """(N,)"""
    sigma: tuple[float, ...]
    """(N,) standard uncertainty of both."""
    of: str
    """Name of the sensor or of the angle."""


@dataclass(frozen=True)
class GroupFinding(Document, forms={"since": MOMENT}):
    """One lasting effect."""

    cause: str
    level: str
    """Level of its subject: ``unit``, ``type`` or ``stand``."""
    subject: str
    """Serial of the unit, name of the type, id of the stand."""
    sensors: tuple[str, ...]
    """``*`` for every sensor of a kind; none for a cause of stand or fixture."""
    kind: str
    """Kind of the sensors; empty without any."""
    amplitude: tuple[float, ...]
    sigma: tuple[float | None, ...]
    """One sigma of each amplitude; None where the pool does not see it."""
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
    rivals: tuple[GroupRival, ...]
    sentence: str
    advice: str
    sessions: tuple[SessionAmplitude, ...]
    picture: Picture | None = None
    """Pooled residual of one sensor against what the effect depends on, without and with it; None without sessions."""


@dataclass(frozen=True)
class GroupStructure:
    """Structure that all sessions share and no cause explains."""

    where: str
    subject: str
    sensors: tuple[str, ...]
    strength: float


@dataclass(frozen=True)
class PoolLimit(Limit, order=("cause", "amplitude", "units", "visible", "reason", "one_session")):
    """Limit of the pool at 95 % power, and that of its latest session."""

    one_session: tuple[float, ...] | None
    """The amplitude of the latest session alone; None when it cannot see the cause."""


@dataclass(frozen=True)
class Moved:
    """Largest change of the parameters of a session because the findings are modelled, in their own sigma."""

    parameter: str
    sensor: str
    change: float
    """SI."""
    sigmas: float


@dataclass(frozen=True)
class GroupGain(Document, optional=("before", "after")):
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
    before: dict[str, dict[str, float]] | None = None
    """Root mean square residual, m/s² (rad/s), of every sensor in the latest session, by kind and name, without the
    findings; None where that session was not at hand."""
    after: dict[str, dict[str, float]] | None = None
    """Root mean square residual with the findings, at the amplitudes that earlier sessions fixed; as ``before``."""


@dataclass(frozen=True)
class EmpiricalTerm:
    """A term that was learned from the sessions: it describes, and names no physical cause."""

    equation: str
    """Equation of the term, with units."""
    words: tuple[str, ...]
    """Factor that each amplitude multiplies: ``sin 3β``; for the applied vector with the angle it turns, ``δβ: sin
    3β``.
    """
    sensors: tuple[str, ...]
    """Names of the sensors; empty where it acts on the applied vector."""
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
    """Separation from that cause, on the pool, standard errors of a reading."""
    picture: Picture
    """Pooled residual against its variable, before and after."""
    level: str = ""
    """Level of its subject: ``unit``, ``type`` or ``stand``."""


@dataclass(frozen=True)
class GroupDiagnosis(
    Document,
    format="imu-fleet-diagnosis/1",
    order=(
        "level", "subject", "sessions", "first", "last", "findings", "terms", "unexplained", "structures", "limits",
        "gain", "e_value", "notes",
    ),
    keys={"subject": "id"},
):  # fmt: skip
    """Diagnosis of a group of sessions."""

    level: str
    subject: str
    sessions: int
    first: str | None
    """Start of the oldest session; None where it states none."""
    last: str | None
    """Start of the latest session; None where it states none."""
    findings: tuple[GroupFinding, ...]
    terms: tuple[EmpiricalTerm, ...]
    structures: tuple[GroupStructure, ...]
    limits: tuple[PoolLimit, ...]
    gain: GroupGain | None
    """Gain on later sessions; None without findings, or with too few sessions to leave any out."""
    e_value: float
    """E-value of the group against no effect beside the findings."""
    notes: tuple[str, ...] = ()

    @property
    def unexplained(self) -> bool:
        """Whether sessions share structure that no cause explains."""
        return bool(self.structures)
