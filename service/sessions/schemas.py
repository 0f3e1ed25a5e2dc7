"""Sessions, receipts, decisions."""

from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, Field
from pydantic.config import JsonDict

from estimator.json_object import Json
from service.judging.covered import CoveredTemperatures
from service.judging.records import SaidVerdict, said
from service.kit.answer import answer
from service.papers.records import Traceability
from service.sessions.decision import Verdict
from service.sessions.records import Marks, Receipt, StoredSession
from service.web.fields import Paged

RECEIPT_EXAMPLE: JsonDict = {
    "id": "3f9a0c5be1d24786aa10",
    "unit": "BA-017",
    "verdict": "fail",
    "reason": "A3 bias changed by +62 µg (U 8.1 µg), beyond the tolerance of ±50 µg.",
    "created": True,
    "is_reference": False,
    "reservations": [],
    "said": "Unfit",
    "state": "accepted",
    **Marks().marks,
    "url": "http://127.0.0.1:8000/api/v1/sessions/3f9a0c5be1d24786aa10",
}


@answer
@dataclass(frozen=True, kw_only=True)
class ReceiptAnswer(SaidVerdict, Receipt):
    """The answer to an upload."""

    url: str
    """Address of the session."""


@answer
@dataclass(frozen=True, kw_only=True)
class SaidSession(SaidVerdict, StoredSession):
    """One stored session."""


def said_session(session: StoredSession) -> SaidSession:
    """The session with its verdict in words."""
    return SaidSession(**said(session))


class TemperatureCorrectionSchema(BaseModel):
    """A change from the reference without the effect of temperature, by the law of the unit's sessions before."""

    model_config = ConfigDict(from_attributes=True)

    measured: float = Field(description="Change at the session's temperature: relative for scale, else SI.")
    corrected: float = Field(description="The same at the reference's temperature: what is judged.")
    expanded: float = Field(description="U of the corrected change, that of the law in it.")
    worth: float = Field(description="What the difference in temperature is worth: measured minus corrected.")
    sigma: float = Field(description="Standard uncertainty of it, with what the sessions scatter about the law.")
    dof: float | None = Field(description="Degrees of freedom of that; null where they scatter by no more than noise.")
    temperature: float = Field(description="Of the session, mean, °C.")
    reference_temperature: float = Field(description="Of the reference session, mean, °C.")
    sessions: int = Field(description="How many sessions the law was learned from.")
    lowest: float | None = Field(None, description="Of the coldest of them, °C; null where it was not kept.")
    highest: float | None = Field(None, description="Of the warmest, °C.")
    units: int = Field(0, description="How many units of its type it was learned from too.")


class DecisionSchema(BaseModel):
    """One parameter of one sensor, judged."""

    model_config = ConfigDict(from_attributes=True)

    sensor: str = Field(description="Name of the sensor.")
    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    parameter: str = Field(description="`scale`, `bias`, `quadratic`, `axis` or `misalignment`.")
    value: float | None = Field(description="Measured, SI; for the axis the angle from the reference axis, rad.")
    reference: float | None = Field(description="The reference session's value, SI; 0 for the axis.")
    deviation: float | None = Field(description="y, from the reference: relative for scale, else SI.")
    uncertainty: float | None = Field(description="u, standard uncertainty of the deviation, of both sessions.")
    expanded: float | None = Field(description="U = k·u.")
    coverage_factor: float = Field(
        description="k; Student's t where the noise is known to few degrees of freedom (JCGM 100, G.4)."
    )
    dof: float | None = Field(description="Effective degrees of freedom of u; null when the noise is known.")
    tolerance: float = Field(description="T, in the unit of the deviation.")
    guard_band: float | None = Field(description="w = U.")
    probability_out: float | None = Field(description="Probability that the true deviation is out of tolerance.")
    critical: float | None = Field(
        description="Smallest deviation that counts as a change, at 1 % over all judged numbers of the session."
    )
    verdict: Verdict = Field(description="The state of this parameter.")
    rule: str = Field(description="Name and version of the rule, and the type and revision of its tolerances.")
    change: list[float] | None = Field(
        description="The deviation with sign and direction; for the axis along the two tangents of the reference axis."
    )
    change_own: list[float] | None = Field(description="Standard uncertainty of it that this session brings.")
    change_origin: list[float] | None = Field(description="The same of the reference session.")
    common: float | None = Field(
        description="What all sensors did together, taken off first: turn of the block for the axis (rad), "
        "relative change of all scales."
    )
    common_sigma: float | None = Field(description="Standard uncertainty of it.")
    common_p: float | None = Field(description="Chance of a common change as large when nothing moved together.")
    temperature_correction: TemperatureCorrectionSchema | None = Field(
        description="What was taken off for the session's temperature before it was judged; null where nothing was."
    )


class CommonMotionSchema(BaseModel):
    """Common motion of the axes, or of the scales, of all sensors of one kind since the reference."""

    model_config = ConfigDict(from_attributes=True)

    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    quantity: str = Field(description="`axes` or `scales`.")
    state: str = Field(
        description="`separated`; `too-few-sensors`, `unclear` or `beyond-input` (more than gravity or a clock can "
        "do): nothing was taken off, every sensor was judged on its whole change."
    )
    value: list[float] = Field(description="Rotation vector in block axes, rad, or relative change of all scales.")
    covariance: list[list[float]] = Field(description="Of the value, both sessions.")
    p_value: float | None = Field(description="Chance of a common change as large when nothing moved together.")
    sensors: list[str] = Field(description="That it rests on.")
    left_out: list[str] = Field(description="That moved on their own.")


@answer
@dataclass(frozen=True, kw_only=True)
class SessionReportAnswer(SaidSession):
    """One stored session with its decisions."""

    decisions: tuple[DecisionSchema, ...]
    """Decisions on every judged parameter, sensor after sensor."""
    common_motion: tuple[CommonMotionSchema, ...]
    """Motions common to all sensors; empty for a reference and for sessions judged before they were kept."""
    stand_certificate_expired: bool
    """Whether the stand's own certificate had expired at the day of measurement: the verdict stands, its traceability
    does not."""
    traceability: Traceability
    """Traceability of the session's results."""
    temperatures_covered: CoveredTemperatures | None = None
    """Temperatures covered by the unit's calibrations up to this one; null where there is no reference, or where its
    temperature was not recorded.
    """


class SessionPage(Paged):
    """One page of sessions, newest measurement first."""

    sessions: list[SaidSession] = Field(description="The sessions of this page.")


class CalibrationDocument(BaseModel):
    """imu-calibration/1: parameters in SI with their full covariance."""

    format: str = Field(description="`imu-calibration/1`.")
    unit: str = Field(description="Serial number of the unit.")
    method: str = Field(description="How the parameters were estimated.")
    sensors: list[Json] = Field(
        description="Scale, bias, quadratic term and axis of every sensor, with total one-sigma uncertainties."
    )
    fit: Json = Field(description="χ², degrees of freedom, p-value, rank, weakest direction.")
    gauge: str = Field(description="What holds the block's frame.")
    covariance: Json = Field(description="Names and units of all elements; total and repeatability.")
    residuals: Json = Field(description="Measured minus modelled, row by row, at the input.")
