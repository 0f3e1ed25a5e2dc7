"""Stored sessions, lists of them, and the history of their parameters."""

from collections.abc import Collection
from dataclasses import dataclass, fields
from datetime import datetime
from enum import StrEnum
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, computed_field

from service.kit.answer import Hidden, answer
from service.kit.listing import ListQuery
from service.kit.moments import epoch_ms
from service.sessions.decision import Verdict
from service.sessions.doubt import Reservations
from service.sessions.states import RecordState

PARAMETERS = ("scale", "bias", "quadratic", "axis")
"""Parameters of every sensor in a calibration."""
ID_DIGITS = 20
"""Digits of the file's SHA-256: 80 bits; among a million sessions two share them with probability 4e-13."""


ALL_PARAMETERS = (*PARAMETERS, "misalignment")
"""All parameters: these, and the one that only a turntable shows."""


@dataclass(frozen=True, kw_only=True)
class Marks:
    """Yes-or-no marks of a session, set with its file or later; carried whole wherever it goes."""

    is_check: bool = False
    """Whether it is only a check, which moves no due date unless it is a reference."""

    @property
    def marks(self) -> dict[str, Any]:
        """Each by its name."""
        return {field.name: getattr(self, field.name) for field in fields(Marks)}

    @property
    def words(self) -> tuple[str, ...]:
        """Marks that are set, by their names in addresses, forms and lists."""
        return tuple(word for word, name in MARKS.items() if getattr(self, name))


MARKS = {field.name.removeprefix("is_"): field.name for field in fields(Marks)}
"""The word of each mark, and its name."""


def marks_said(words: Collection[str]) -> dict[str, Any]:
    """All marks by their names; those of these words are so."""
    return {name: word in words for word, name in MARKS.items()}


@dataclass(frozen=True)
class _StoredSession:
    """A stored session without its marks."""

    id: str
    """Id of the session: the first 20 digits of the content's SHA-256."""
    unit: str
    """Serial number of the unit."""
    sha256: str
    """SHA-256 of the uploaded bytes."""
    filename: str
    """Name of the file when it was uploaded."""
    size: int
    """Bytes."""
    programme: str
    """Programme of measurement."""
    stand: str | None
    """The stand, if one was used."""
    operator: str
    """Operator by the file."""
    notes: str
    """Notes of the file."""
    started_at: datetime
    """Start of the measurement, with the offset from UTC in the file; the upload's time where the file states none."""
    uploaded_at: datetime
    """Time of upload, UTC."""
    verdict: Verdict
    """The worst of the session's parameters."""
    reason: str
    """Reason for the verdict, in one sentence."""
    is_reference: bool
    """Whether later sessions are judged against this one."""
    simulated: bool
    """Whether it was simulated, not measured."""
    revision: int = 0
    """Model revision that its calibration in force was made under; 0 is the baseline."""
    stage: str | None = None
    """`as-found`, `as-left`, or null where neither was said."""
    reservations: Hidden[Reservations] = ()
    """Reservations of the verdict."""
    state: RecordState = RecordState.ACCEPTED
    """State of the record; only an accepted session counts for its unit."""
    superseded_by: str | None = None
    """The replacement of a superseded session."""
    temperature: Hidden[float | None] = None
    """°C, the mean over the session; None where it was not recorded."""
    time_since_power_on: float | None = None
    """Seconds from switching the unit on to the first row; null where the file does not say."""


@answer
@dataclass(frozen=True)
class StoredSession(Marks, _StoredSession):
    """One stored session."""


@dataclass(frozen=True)
class Digests:
    """Digests by which a session is recognised, whatever its file's bytes."""

    content_digest: str
    """Digest of its whole content."""
    readings_digest: str
    """Digest of its readings alone."""


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
class _Receipt:
    """Answer to an upload, without the session's marks."""

    id: str
    """The session's id, made from the content: the same bytes have the same id."""
    unit: str
    """Serial number of the unit."""
    verdict: Verdict
    """Verdict of the session: the worst of its parameters."""
    reason: str
    """Reason for the verdict, in one sentence."""
    created: bool
    """Whether it is new; false when the same bytes were already stored."""
    is_reference: bool
    """Whether later sessions are judged against this one; then its own verdict is `undecidable`."""
    reservations: Hidden[Reservations] = None
    """Reservations of the verdict."""
    state: RecordState = RecordState.ACCEPTED
    """`questioned` where the file cannot be as it says; then it counts for nothing."""
    remark: str = ""
    """Further remark, such as that the unit is retired; empty where there is none."""


@answer
@dataclass(frozen=True)
class Receipt(Marks, _Receipt):
    """The answer to an upload; for an earlier stored file it states the session as it is."""


class SessionOrder(StrEnum):
    """Order of a list of sessions; equal ones are ordered by the date of measurement and the identifier."""

    MEASURED = "measured"
    """The newest first."""
    UPLOADED = "uploaded"
    """The latest upload first."""
    VERDICT = "verdict"
    """The worst verdict first."""
    UNIT = "unit"


@dataclass(frozen=True)
class SessionQuery(ListQuery):
    """Filter of sessions, and the identifier after or before which the list goes on."""

    text: str | None = None
    """Part of the unit's serial number, small and capital letters alike."""
    unit: str | None = None
    """The whole serial number."""
    unit_type: str | None = None
    stand: str | None = None
    since: datetime | None = None
    """Measured then or later."""
    until: datetime | None = None
    """Measured before."""
    state: RecordState | None = None
    verdict: Verdict | None = None
    is_reference: bool | None = None
    """Whether later sessions are judged against it; None where either will do."""
    reserved: bool = False
    """Whether only sessions whose verdict has a reservation are wanted."""
    order: SessionOrder = SessionOrder.MEASURED


@answer
@dataclass(frozen=True)
class HistoryPoint:
    """One parameter of one sensor at one session, ready for drawing a band."""

    session: str
    """Id of the session."""
    at: datetime
    """Start of the measurement, UTC."""
    sensor: str
    """Name of the sensor."""
    kind: str
    """`accelerometer` or `gyroscope`."""
    parameter: str
    """`scale`, `bias`, `quadratic`, `axis`, `misalignment`, or a term of noise at rest."""
    value: float | None
    """SI; for the axis the angle from the reference axis as judged, rad."""
    u: float | None
    """Standard uncertainty of the value."""
    lower: float | None
    """Value minus expanded uncertainty; of a term of noise the end of its 95 % interval."""
    upper: float | None
    """Value plus expanded uncertainty; of a term of noise the end of its 95 % interval."""
    reference: float | None
    """The value that it is judged against."""
    deviation: float | None
    """Change from the reference, as it was judged: relative for scale, else SI."""
    expanded: float | None
    """U of the deviation, of both sessions."""
    tolerance: float | None
    """Tolerance in the unit of the value; null where it is not judged."""
    verdict: Verdict
    """The state of this parameter at this session."""
    is_reference: bool
    """Whether the session is one that later ones are judged against."""
    axis: tuple[float, float, float] | None
    """Components of the axis in block axes; null for other parameters."""
    revision: int = 0
    """Model revision that it was computed under; 0 is the baseline."""

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def at_ms(self) -> int:
        """`at` in milliseconds since 1970."""
        return epoch_ms(self.at)


class DiagnosisState(StrEnum):
    """Result of a diagnosis; not applicable: no causes are looked for in sessions of its programme."""

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
    gain: str = ""
    """Gain from the named causes, in one sentence."""


UNWEIGHED = "~"
"""Heads the basis of a verdict beside which a diagnosis is still to be weighed."""


class TermSchema(BaseModel):
    """One Allan term."""

    model_config = ConfigDict(from_attributes=True)

    name: str = Field(description="`quantisation`, `white-noise`, `bias-instability` or `random-walk`.")
    value: float | None = Field(description="SI; null where a record of this length does not decide it.")
    sigma: float | None = Field(description="One sigma of the value.")
    most: float | None = Field(description="Of a term that is not decided: what it hardly exceeds, SI.")


class SensorNoiseSchema(BaseModel):
    """One sensor's terms, and the curve that they were read from."""

    name: str = Field(description="Name of the sensor.")
    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    terms: list[TermSchema] = Field(description="All four.")
    tau_s: list[float] = Field(description="Averaging times, s.")
    deviation: list[float] = Field(description="Overlapping Allan deviation, m/s² or rad/s.")
    freedom: list[float] = Field(description="Its effective degrees of freedom.")
    holds_s: tuple[float, float] | None = Field(description="Shortest and longest time that the terms describe.")


class NoiseDocument(BaseModel):
    """imu-noise/1: noise of the sensors from the rests of a raw log."""

    format: str = Field(description="`imu-noise/1`.")
    rests: int = Field(description="How many rests.")
    longest_s: float = Field(description="The longest of them, s.")
    lasted_s: float = Field(description="All together, s.")
    sensors: list[SensorNoiseSchema] = Field(description="In the order of the session.")


@dataclass(frozen=True)
class Achieved:
    """A change of one parameter of one sensor from its reference; SI, relative of a scale factor."""

    kind: str
    parameter: str
    deviation: float | None
    """None for a reference."""
    expanded: float | None
    """U."""
    tolerance: float
