"""Result types of the diagnosis; no algorithms. The JSON form is ``imu-diagnosis/1``."""

from dataclasses import dataclass, field

from estimator.codec import MOMENT, Document
from estimator.json_object import Json
from estimator.results import Calibration, Residuals


@dataclass(frozen=True)
class Separation(
    Document,
    keys={"now": "separation", "then": "expected_separation"},
    order=("cause", "sensors", "now", "measurement", "then"),
):
    """Separation of a rival cause from the named one, and the measurement that would tell them apart."""

    cause: str
    sensors: tuple[str, ...]
    now: float
    """Separation in this session, standard errors of a reading."""
    measurement: str
    """Measurement to add, in words; empty when nothing that the planner knows would do."""
    then: float | None
    """Expected separation with that measurement."""


@dataclass(frozen=True)
class Rival:
    """One line of the ranking of causes."""

    cause: str
    sensors: tuple[str, ...]
    probability: float
    """Share among all causes of the catalogue, given that one of them acts."""
    strength: float
    """Norm of the fitted signature in standard errors of a reading."""


@dataclass(frozen=True)
class ParitySplit:
    """χ² in parity space and in the range of the axes, with the effect left in and taken out."""

    signature_in_parity: float
    """Share of the signature's energy, before any fit, in parity space: 0 for a pure stand error."""
    parity_before: float
    parity_after: float
    range_before: float
    range_after: float


@dataclass(frozen=True)
class OverSessions(Document, forms={"since": MOMENT}):
    """The evidence of several sessions of the unit, where one alone does not show an effect."""

    sessions: int
    """Number of sessions that contribute evidence, this one among them."""
    e_value: float
    """E-value: without an effect it ever reaches 100 in at most one unit of a hundred."""
    form: str
    """``same``, ``varying`` from session to session, or ``since`` a session."""
    since: str | None
    """Start of the first session that has it, where earlier ones had not; None too where that states none."""
    spread: tuple[float, ...]
    """τ between sessions of each sensor in turn, in the unit of its amplitudes."""
    here: float
    """Probability that this session has it too."""


@dataclass(frozen=True)
class Shared(
    Document,
    order=(
        "group",
        "shape",
        "shape_sigma",
        "more",
        "more_amplitude",
        "more_sigma",
        "drawn_for",
        "course",
        "measured",
        "band",
        "shape_in_doubt",
    ),
    optional=("shape_in_doubt",),
):
    """The one course that the sensors of a finding follow, each by a size of its own. R rows."""

    group: str
    """``all`` sensors of the block, all of a kind (``accelerometer``, ``gyroscope``), or ``some``."""
    shape: dict[str, float]
    """The shape parameters that all have, by unit, rows counted from 1."""
    shape_sigma: dict[str, float]
    """Sigmas of the continuous shape parameters, where the session determines them."""
    more: tuple[str, ...]
    """Sensors that follow it below what can be named of one alone."""
    more_amplitude: tuple[float, ...]
    """Amplitudes of those sensors, in the unit of the finding's amplitudes for their kind."""
    more_sigma: tuple[float, ...]
    drawn_for: str
    """The sensor that shows it most, whose course is drawn."""
    course: tuple[float, ...]
    """(R,) m/s² (rad/s), as that sensor has it, about its mean."""
    measured: tuple[float, ...]
    """(R,) the course as measured by all sensors together, each scaled onto that one."""
    band: tuple[float, ...]
    """(R,) one standard error of ``measured``."""
    shape_in_doubt: bool = False
    """Whether every sensor may as well have a shape of its own: odds below a hundred for a common one."""


def _with_all_shapes(document: Json) -> Json:
    """Earlier versions stated the shape of the first sensor alone."""
    return document | {"nonlinear_each": document.get("nonlinear_each") or [document["nonlinear"]]}


@dataclass(frozen=True)
class Finding(
    Document,
    order=(
        "cause", "sensors", "amplitude", "sigma", "units", "nonlinear", "nonlinear_each", "p_value", "strength",
        "alternatives", "separations", "ranking", "sentence", "advice", "parity", "new", "over_sessions",
        "shared", "since_power_on",
    ),
    optional=("shared", "since_power_on"),
    earlier=_with_all_shapes,
):  # fmt: skip
    """One named cause with its evidence."""

    cause: str
    sentence: str
    advice: str
    sensors: tuple[str, ...]
    p_value: float
    """Chance, without an effect, of this or anything as strong anywhere in the catalogue (family-wise)."""
    strength: float
    """Strength in standard errors of a reading."""
    amplitude: tuple[float, ...] = ()
    sigma: tuple[float, ...] = ()
    units: tuple[str, ...] = ()
    nonlinear_each: tuple[dict[str, float], ...] = ({},)
    """Shape parameters of every sensor in turn, such as τ or the row of a jump (counted from 1), by unit,
    numbered where two share one; one entry where the cause acts on none."""
    alternatives: tuple[str, ...] = ()
    separations: tuple[Separation, ...] = ()
    ranking: tuple[Rival, ...] = ()
    parity: ParitySplit | None = None
    """χ² in which stand and sensor differ; None where there is no redundancy."""
    new: bool | None = None
    """Whether it arose since the history; None without history or where the session cannot tell."""
    over_sessions: OverSessions | None = None
    """Evidence of several sessions where one alone shows too little; the amplitudes are then theirs. None where this
    session shows the effect itself.
    """
    shared: Shared | None = None
    """The common course of all its sensors; None where each is a matter of its own."""
    since_power_on: float | None = None
    """Time from switching on, from which the amplitudes count, to the first row, s; None where it is not known, and for
    causes without such a time.
    """

    @property
    def nonlinear(self) -> dict[str, float]:
        """Shape parameters of the first sensor."""
        return self.nonlinear_each[0]


@dataclass(frozen=True)
class Course:
    """The course of the applied vector that explains the readings of all sensors. R rows, c components."""

    order: str
    """Order of the rows along which it is smooth."""
    components: tuple[str, ...]
    """Changing components: ``β``, ``α``, ``size``; empty where the whole vector turned once."""
    values: tuple[tuple[float, ...], ...]
    """(R, c), rad; the size relative."""


@dataclass(frozen=True)
class NoiseScale:
    """Stated standard errors of sensors of a kind that their readings contradict."""

    kind: str
    factor: float
    """Factor by which they are too small; below one they are too large."""
    freedom: float
    """Degrees of freedom of the factor."""
    sensors: tuple[str, ...] = ()
    """Sensors concerned; empty where all sensors of the kind are."""


@dataclass(frozen=True)
class Structure(Document):
    """Structure that no cause of the catalogue explains, and where it lives."""

    where: str
    """Place of the structure in words: sensors, harmonic of β, time, temperature; common or not."""
    sensors: tuple[str, ...]
    p_value: float
    strength: float
    course: Course | None = None
    """Course of the applied vector, where the structure is common to all sensors and in no pattern."""
    of_record: bool = False
    """Whether the record is mixed up: no effect of sensors or stand looks like it."""


@dataclass(frozen=True)
class Score(Document, optional=("rms_by_sensor",)):
    """Quality of a model's prediction of readings that it has not seen."""

    rms: float
    """Root mean square error of the sensors of the block's kind, m/s² (rad/s)."""
    chi2_per_dof: float
    log_score: float
    """Mean log predictive density of a reading, in units of its own sigma."""
    rms_by_kind: dict[str, float] = field(default_factory=dict)
    """Root mean square error by kind of sensor, each in its own unit."""
    rms_by_sensor: dict[str, dict[str, float]] | None = None
    """Root mean square error by kind and name of sensor; None where it is not stated."""


@dataclass(frozen=True)
class Transfer(Document, forms={"started_at": MOMENT}):
    """Agreement of an earlier session with amplitudes found in this one."""

    started_at: str | None
    """Start of the earlier session."""
    before: Score
    after: Score


@dataclass(frozen=True)
class Gain:
    """Prediction of readings that took no part in the fit, without and with the named causes."""

    before: Score
    after: Score
    held_out: str
    """``positions``: those of this session, fold by fold."""
    session: Transfer | None = None
    """The latest earlier session, where a finding can have acted there too."""


@dataclass(frozen=True)
class Limit(Document, order=("cause", "amplitude", "units", "visible", "reason")):
    """The smallest effect that this session would have found, or why it cannot see the cause."""

    cause: str
    amplitude: tuple[float, ...] | None
    """Limit of each amplitude alone, at the sensor that shows it worst; for an effect that settles, its size at the
    first row. None when the session cannot see the cause.
    """
    units: tuple[str, ...]
    reason: str
    """Reason why the cause is not visible; empty when it is."""

    @property
    def visible(self) -> bool:
        """Whether the session can see the cause."""
        return self.amplitude is not None


@dataclass(frozen=True, eq=False)
class Diagnosis(
    Document,
    format="imu-diagnosis/1",
    order=(
        "unit", "findings", "unexplained", "structures", "gain", "limits", "calibration", "residuals_before", "noise",
        "notes",
    ),
):  # fmt: skip
    """Diagnosis of a session: the effects that the simulation lacks."""

    unit: str
    findings: tuple[Finding, ...]
    structures: tuple[Structure, ...]
    gain: Gain
    limits: tuple[Limit, ...]
    baseline: Calibration
    """Calibration under the baseline model."""
    calibration: Calibration
    """Calibration under the extended model."""
    noise: tuple[NoiseScale, ...] = ()
    """Kinds of sensor whose stated standard errors the readings contradict."""
    notes: tuple[str, ...] = field(default=())

    @property
    def residuals_before(self) -> Residuals:
        """Residuals under the baseline model."""
        return self.baseline.residuals

    @property
    def unexplained(self) -> bool:
        """Whether there is structure that no cause explains."""
        return bool(self.structures)
