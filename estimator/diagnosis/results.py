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
    """How far a rival cause is from the named one, and what would distinguish them."""

    cause: str
    sensors: tuple[str, ...]
    now: float
    """Separation in this session, standard errors of a reading."""
    measurement: str
    """What to add, in words; empty when nothing that the planner knows would do."""
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
    """That speak of it, this one among them."""
    e_value: float
    """Without an effect it ever reaches 100 in at most one unit of a hundred."""
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
    """Of those that are continuous, where the session determines them."""
    more: tuple[str, ...]
    """Sensors that follow it below what can be named of one alone."""
    more_amplitude: tuple[float, ...]
    """Of these, in the unit of the finding's amplitudes for their kind."""
    more_sigma: tuple[float, ...]
    drawn_for: str
    """The sensor that shows it most, whose course is drawn."""
    course: tuple[float, ...]
    """(R,) m/s² (rad/s), as that sensor has it, about its mean."""
    measured: tuple[float, ...]
    """(R,) the same as all sensors together read it, each scaled onto that one."""
    band: tuple[float, ...]
    """(R,) one standard error of what they read."""
    shape_in_doubt: bool = False
    """Whether every sensor may as well have a shape of its own: odds below a hundred for one of all."""


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
    """Of this or anything as strong anywhere in the catalogue, were there no effect (family-wise)."""
    strength: float
    """In standard errors of a reading."""
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
    """Where stand and sensor differ; None where there is no redundancy."""
    new: bool | None = None
    """Whether it came since the history; None without history or where the session cannot tell."""
    over_sessions: OverSessions | None = None
    """Of what only several sessions show together: the amplitudes are theirs; None of what this session shows."""
    shared: Shared | None = None
    """Where all its sensors follow one course; None where each is a matter of its own."""
    since_power_on: float | None = None
    """s, from switching on, where the amplitudes are counted from, to the first row; None where that is not known, and
    of causes that have no such time."""

    @property
    def nonlinear(self) -> dict[str, float]:
        """Shape parameters of the first sensor."""
        return self.nonlinear_each[0]


@dataclass(frozen=True)
class Course:
    """How the applied vector must have run for all sensors to read what they did. R rows, c components."""

    order: str
    """Along which it is smooth."""
    components: tuple[str, ...]
    """What changes: ``β``, ``α``, ``size``; empty where the whole vector turned once."""
    values: tuple[tuple[float, ...], ...]
    """(R, c), rad; the size relative."""


@dataclass(frozen=True)
class NoiseScale:
    """Stated standard errors of sensors of a kind that their readings contradict."""

    kind: str
    factor: float
    """By which they are too small; below one they are too large."""
    freedom: float
    """Degrees of freedom that tell it."""
    sensors: tuple[str, ...] = ()
    """Whose they are; none where they are those of all sensors of the kind."""


@dataclass(frozen=True)
class Structure(Document):
    """Structure that no cause of the catalogue explains, and where it lives."""

    where: str
    """In words: which sensors, harmonic of β, time, temperature; common or not."""
    sensors: tuple[str, ...]
    p_value: float
    strength: float
    course: Course | None = None
    """Of the applied vector, where it is common to all sensors and in no pattern."""
    of_record: bool = False
    """Whether the record is mixed up: nothing that sensors or stand do looks like it."""


@dataclass(frozen=True)
class Score(Document, optional=("rms_by_sensor",)):
    """How well a model predicts readings it has not seen."""

    rms: float
    """Of the sensors of the block's kind, m/s² (rad/s)."""
    chi2_per_dof: float
    log_score: float
    """Mean log predictive density of a reading, in units of its own sigma."""
    rms_by_kind: dict[str, float] = field(default_factory=dict)
    """The same of every kind of sensor, each in its own unit."""
    rms_by_sensor: dict[str, dict[str, float]] | None = None
    """The same of every sensor by name, by kind; None where it is not stated."""


@dataclass(frozen=True)
class Transfer(Document, forms={"started_at": MOMENT}):
    """How well an earlier session agrees with amplitudes found in this one."""

    started_at: str | None
    """Of the earlier session."""
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
    """Per amplitude element, alone, at the sensor where it is seen worst, of what settles as it is at the first row;
    None when the session cannot see it."""
    units: tuple[str, ...]
    reason: str
    """Why not visible; empty when visible."""

    @property
    def visible(self) -> bool:
        """Whether the session can see it."""
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
    """What the simulation gets wrong about a session."""

    unit: str
    findings: tuple[Finding, ...]
    structures: tuple[Structure, ...]
    gain: Gain
    limits: tuple[Limit, ...]
    baseline: Calibration
    """Under the baseline model."""
    calibration: Calibration
    """Under the extended model."""
    noise: tuple[NoiseScale, ...] = ()
    """Kinds of sensor whose stated standard errors the readings contradict."""
    notes: tuple[str, ...] = field(default=())

    @property
    def residuals_before(self) -> Residuals:
        """Under the baseline model."""
        return self.baseline.residuals

    @property
    def unexplained(self) -> bool:
        """Whether there is structure that no cause explains."""
        return bool(self.structures)
