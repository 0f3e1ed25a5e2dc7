"""What flows between storage, flows, API and pages: frozen records, complete at birth. SI inside."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any

from estimator.health.common_motion import CommonMotion
from estimator.results import Calibration, Residuals
from estimator.session import CalibrationSession

PARAMETERS = ("scale", "bias", "quadratic", "axis")
"""What a calibration gives of every sensor."""
ALL_PARAMETERS = (*PARAMETERS, "misalignment")
"""With what only a turntable shows."""


class Verdict(StrEnum):
    """The four states of ILAC-G8:2019 with guard band, and the honest fifth. Ordered from good to bad by `severity`."""

    PASS = "pass"
    CONDITIONAL_PASS = "conditional-pass"
    UNDECIDABLE = "undecidable"
    CONDITIONAL_FAIL = "conditional-fail"
    FAIL = "fail"

    @property
    def severity(self) -> int:
        return list(Verdict).index(self)


@dataclass(frozen=True)
class Tolerances:
    """Largest allowed deviation from the reference, per parameter; None where the parameter is not judged."""

    scale: float | None
    """Relative (1e-6 is 1 ppm)."""
    bias: float | None
    """m/s² (rad/s)."""
    quadratic: float | None
    """s²/m (s/rad)."""
    axis: float | None
    """rad."""


@dataclass(frozen=True)
class UnitType:
    """A kind of unit: nominal axes and tolerances that all its units share."""

    name: str
    block: str
    sensors: tuple[str, ...]
    nominal_axes: tuple[tuple[float, float, float], ...]
    nominal_scales: tuple[float, ...]
    tolerances: Tolerances
    gyro_tolerances: Tolerances | None
    """For the gyros of a mixed block; None when the block has one kind of sensor."""
    revision: int
    """Counts up with every change of tolerances; decisions name the revision they were made under."""
    maximum_interval_days: float = 365.0
    """Longest time from a session to the next calibration."""


@dataclass(frozen=True)
class StoredSession:
    """One uploaded session. ``id`` is made from the content, so the same bytes always have the same id."""

    id: str
    unit: str
    sha256: str
    filename: str
    size: int
    programme: str
    stand: str | None
    operator: str
    notes: str
    started_at: datetime
    """UTC; the upload's time when the file states none."""
    uploaded_at: datetime
    verdict: Verdict
    reason: str
    """Why the verdict is what it is, in one sentence a technician understands."""
    is_reference: bool
    simulated: bool
    revision: int = 0
    """The model revision that the calibration in force was made under; 0 is the baseline."""
    stage: str | None = None
    """``as-found`` before the unit was worked on, ``as-left`` after; None where neither was said."""


@dataclass(frozen=True)
class Decision:
    """One parameter of one sensor of one session, judged. Everything the decision rests on is here."""

    sensor: str
    kind: str
    parameter: str
    value: float | None
    """The measured parameter, SI; for the axis the angle from the reference axis, rad."""
    reference: float | None
    """SI; 0 for the axis; None while there is no reference."""
    deviation: float | None
    """From the reference: relative for scale, else SI; for the axis the angle freed of the upward pull of noise."""
    uncertainty: float | None
    """Standard uncertainty of the deviation (both sessions)."""
    expanded: float | None
    """U = k·u."""
    coverage_factor: float
    tolerance: float
    guard_band: float | None
    probability_out: float | None
    """Probability that the true deviation is out of tolerance."""
    verdict: Verdict
    rule: str
    """Name, version and the revision of the tolerances, ``ILAC-G8-four-state/2 (hex-cone rev 2)``."""
    critical: float | None = None
    """Smallest deviation that counts as a change at all, at the 1 % level over all judged numbers of the session."""
    change: tuple[float, ...] | None = None
    """The deviation with its sign and direction: one number; two along the reference's tangents for the axis, rad."""
    change_own: tuple[float, ...] | None = None
    """Standard uncertainty that this session brings to each number of the change."""
    change_origin: tuple[float, ...] | None = None
    """The same of the reference session."""
    common: float | None = None
    """What all sensors did together, taken off first: angle of the turn for the axis, rad; relative for scale."""
    common_sigma: float | None = None
    common_p: float | None = None
    """Chance of a common change as large when nothing moved together."""


@dataclass(frozen=True)
class ParameterValue:
    """One parameter of one sensor as a session measured it."""

    sensor: str
    sensor_index: int
    kind: str
    parameter: str
    value: float | None
    """SI; None for the axis, which has components instead."""
    u: float | None
    """Standard uncertainty; for the axis the root of the trace of its covariance, rad."""
    axis: tuple[float, float, float] | None


@dataclass(frozen=True)
class Worst:
    """The parameter that a session's verdict hangs on; all None when nothing was judged."""

    sensor: str | None
    parameter: str | None
    margin: float | None
    """1 − (|d| + U)/T."""


@dataclass(frozen=True)
class HistoryPoint:
    """One parameter of one sensor at one session, ready for drawing a band."""

    session: str
    at: datetime
    sensor: str
    kind: str
    parameter: str
    value: float | None
    """SI; for the axis the angle from the reference axis, rad."""
    u: float | None
    """Standard uncertainty of value."""
    lower: float | None
    """value − U."""
    upper: float | None
    reference: float | None
    deviation: float | None
    """From the reference, as it was judged: relative for scale, else SI; None where there was none to compare with."""
    expanded: float | None
    """U of the deviation, of both sessions."""
    tolerance: float | None
    """In the unit of value (for scale: relative tolerance times the reference); None where it is not judged."""
    verdict: Verdict
    is_reference: bool
    """Whether the session is one that later ones are judged against."""
    axis: tuple[float, float, float] | None
    revision: int = 0
    """The model revision that it was computed under."""


@dataclass(frozen=True)
class Service:
    """A known break in a unit's history: adjustment, repair, sensor swap, new reference."""

    id: int
    unit: str
    at: datetime
    kind: str
    note: str
    who: str = ""
    sensor: str = ""
    """That it concerns; empty for the whole unit."""


@dataclass(frozen=True)
class UnitSummary:
    """One line of the fleet page."""

    serial: str
    unit_type: str
    simulated: bool
    sessions: int
    last_session: str | None
    last_at: datetime | None
    verdict: Verdict | None
    """Of the latest session; None when the unit has none."""
    is_reference: bool
    """Whether the latest session is one that later ones are judged against."""
    reason: str
    worst_sensor: str | None
    worst_parameter: str | None
    margin: float | None
    """1 − (|d| + U)/T of the worst parameter: 1 is spotless, 0 the edge of pass, negative beyond."""
    diagnosis: str = ""
    """What the simulation gets wrong about the latest session, in one line; empty where nothing is wrong."""
    flags: int = 0
    """How many are open."""
    due: datetime | None = None
    """Of the next calibration."""
    lot: str | None = None
    """Of production."""


@dataclass(frozen=True)
class FleetCondition:
    """How many units are in which condition."""

    units: int
    verdicts: dict[Verdict, int]
    """Every verdict is a key."""
    simulated: int
    flags: int = 0
    """How many are open on all units together."""


@dataclass(frozen=True)
class UnitReport:
    """Everything a unit's page or answer shows, apart from its history."""

    summary: UnitSummary
    unit_type: UnitType
    reference_session: str | None
    """What the next session will be judged against; None when the next one becomes the reference."""
    sessions: tuple[StoredSession, ...]
    """The latest ones, newest first."""
    services: tuple[Service, ...]
    """All known breaks, oldest first."""


@dataclass(frozen=True)
class SessionReport:
    """Everything a session's page or answer shows."""

    session: StoredSession
    calibration: Calibration
    """As computed at upload; `storage` rebuilds it from what it kept."""
    decisions: tuple[Decision, ...]
    motions: tuple[CommonMotion, ...] = ()
    """What all sensors did together since the reference."""


@dataclass(frozen=True)
class Judged:
    """A session on its way into the store."""

    source: CalibrationSession
    calibration: Calibration
    decisions: tuple[Decision, ...]
    verdict: Verdict
    reason: str
    worst: Worst
    is_reference: bool
    motions: tuple[CommonMotion, ...] = ()
    """What all sensors did together since the reference."""


@dataclass(frozen=True)
class Receipt:
    """The answer to an upload."""

    id: str
    unit: str
    verdict: Verdict
    reason: str
    created: bool
    """False when the same bytes were already stored."""
    is_reference: bool
    """Whether later sessions are judged against this one."""


class DiagnosisState(StrEnum):
    """What a diagnosis came to; not applicable: no causes are looked for in sessions of its programme."""

    NOTHING = "nothing wrong"
    NAMED = "named"
    UNDECIDED = "cannot tell which"
    UNEXPLAINED = "unexplained"
    FAILED = "failed"
    NOT_APPLICABLE = "not applicable"

    @property
    def is_wrong(self) -> bool:
        """Whether something is wrong that people should hear of."""
        return self in (DiagnosisState.NAMED, DiagnosisState.UNDECIDED, DiagnosisState.UNEXPLAINED)


@dataclass(frozen=True)
class DiagnosisSummary:
    """A session's diagnosis in one line."""

    state: DiagnosisState
    summary: str


@dataclass(frozen=True)
class StoredDiagnosis:
    """What the simulation gets wrong about a session."""

    session: str
    model_revision: int
    """In force when it was made."""
    state: DiagnosisState
    summary: str
    document: dict[str, Any] | None
    """imu-diagnosis/1; None where the session could not be diagnosed."""
    verdict_after: Verdict | None
    """The verdict that the session would have with the named causes in the model."""
    estimator_version: str
    created_at: datetime


class Scope(StrEnum):
    """Whose model an accepted cause becomes part of."""

    UNIT = "unit"
    UNIT_TYPE = "unit type"
    STAND = "stand"


@dataclass(frozen=True)
class NewModel:
    """A cause that an engineer accepts."""

    cause: str
    scope: Scope
    by: str
    note: str


@dataclass(frozen=True)
class ModelRevision:
    """One accepted cause. Revisions are numbered through, so that a number says which model a result rests on."""

    id: int
    scope: Scope
    subject: str
    """Serial number of the unit, or name of the unit type or of the stand."""
    cause: str
    sensors: tuple[str, ...]
    session: str
    evidence: dict[str, Any]
    """Of the finding: p_value, strength, amplitude, sigma, units, and the gain."""
    accepted_by: str
    note: str
    accepted_at: datetime
    withdraws: int | None = None
    """The revision that this one withdraws; None for an accepted cause."""


@dataclass(frozen=True)
class DiagnosisReport:
    """Everything a session's diagnosis page shows."""

    session: StoredSession
    diagnosis: StoredDiagnosis | None
    """None while it is being made."""
    calibration: Calibration
    """In force."""
    before: Residuals | None
    """Measured minus simulated under the baseline model; None without a diagnosis."""
    after: Calibration | None
    """With the named causes in the model."""
    revisions: tuple[ModelRevision, ...]
    """That concern the session, oldest first."""


@dataclass(frozen=True)
class Model:
    """The causes beyond the baseline that a session's calibration takes into account."""

    revision: int
    """The latest revision that concerns the session; 0 for the baseline alone."""
    causes: tuple[tuple[str, tuple[str, ...]], ...]
    """Identifier and sensors of each."""
