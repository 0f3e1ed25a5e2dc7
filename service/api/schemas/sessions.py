"""Sessions, receipts, decisions."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic.config import JsonDict

from service.api.schemas.papers import TraceabilitySchema
from service.api.schemas.reservations import SaidVerdict
from service.records.decision import Verdict
from service.records.state import RecordState

RECEIPT_EXAMPLE: JsonDict = {
    "id": "3f9a0c5be1d24786aa10",
    "unit": "BA-017",
    "verdict": "fail",
    "reason": "A3 bias moved +62 µg (U 8.1 µg) beyond the tolerance of 50 µg.",
    "created": True,
    "is_reference": False,
    "reservations": [],
    "said": "Unfit",
    "state": "accepted",
    "is_check": False,
    "url": "http://127.0.0.1:8000/api/v1/sessions/3f9a0c5be1d24786aa10",
}


class ReceiptSchema(SaidVerdict):
    """The answer to an upload."""

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": RECEIPT_EXAMPLE})

    id: str = Field(description="The session's id, made from the content: the same bytes have the same id.")
    unit: str = Field(description="Serial number of the unit.")
    verdict: Verdict = Field(description="Of the session: the worst of its parameters.")
    reason: str = Field(description="Why, in one sentence.")
    created: bool = Field(description="False when the same bytes were already stored.")
    is_reference: bool = Field(
        description="Whether later sessions are judged against this one; then its own verdict is `undecidable`."
    )
    state: RecordState = Field(description="`questioned` where the file cannot be as it says; then it tells nothing.")
    is_check: bool = Field(description="Whether it is only a check; of what was stored before, as that was.")
    url: str = Field(description="Where the session can be read.")

    def _is_questioned(self) -> bool:
        return self.state is RecordState.QUESTIONED


class SessionSchema(SaidVerdict):
    """One stored session."""

    model_config = ConfigDict(from_attributes=True)

    id: str = Field(description="The first 20 digits of the content's SHA-256.")
    unit: str = Field(description="Serial number of the unit.")
    sha256: str = Field(description="SHA-256 of the uploaded bytes.")
    filename: str = Field(description="What the file was called when it was uploaded.")
    size: int = Field(description="Bytes.")
    programme: str = Field(description="How it was measured.", examples=["two-axis-stand"])
    stand: str | None = Field(description="The stand, if one was used.")
    operator: str = Field(description="Who measured, as the file says.")
    notes: str = Field(description="Notes of the file.")
    started_at: datetime = Field(description="When it was measured, UTC; the upload's time if the file does not say.")
    uploaded_at: datetime = Field(description="When it was uploaded, UTC.")
    verdict: Verdict = Field(description="The worst of the session's parameters.")
    reason: str = Field(description="Why the verdict is what it is, in one sentence.")
    is_reference: bool = Field(description="Whether later sessions are judged against this one.")
    simulated: bool = Field(description="Whether it was simulated, not measured.")
    revision: int = Field(description="Model revision that its calibration in force was made under; 0 is the baseline.")
    is_check: bool = Field(description="Whether it is only a check, which moves no due date unless it is a reference.")
    stage: str | None = Field(description="`as-found`, `as-left`, or null where neither was said.")
    state: RecordState = Field(description="Only an accepted session tells of its unit.")
    superseded_by: str | None = Field(description="The session that stands for a superseded one.")

    def _is_questioned(self) -> bool:
        return self.state is RecordState.QUESTIONED


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


class CommonMotionSchema(BaseModel):
    """What the axes, or the scales, of all sensors of one kind did together since the reference."""

    model_config = ConfigDict(from_attributes=True)

    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    quantity: str = Field(description="`axes` or `scales`.")
    state: str = Field(
        description="`separated`; `too-few-sensors` or `unclear`: nothing was taken off, every sensor was judged on "
        "its whole change."
    )
    value: list[float] = Field(description="Rotation vector in block axes, rad, or relative change of all scales.")
    covariance: list[list[float]] = Field(description="Of the value, both sessions.")
    p_value: float | None = Field(description="Chance of a common change as large when nothing moved together.")
    sensors: list[str] = Field(description="That it rests on.")
    left_out: list[str] = Field(description="That moved on their own.")


class SessionReportSchema(SessionSchema):
    """One stored session with its decisions."""

    decisions: list[DecisionSchema] = Field(description="Every judged parameter, sensor after sensor.")
    common_motion: list[CommonMotionSchema] = Field(
        description="What all sensors did together; empty for a reference and for sessions judged before this was kept."
    )
    stand_certificate_expired: bool = Field(
        description="Whether the stand's own certificate had expired at the day of measurement: the verdict stands, "
        "its traceability does not."
    )
    traceability: TraceabilitySchema = Field(description="What the numbers hang on.")


class SessionPage(BaseModel):
    """One page of sessions, newest measurement first."""

    sessions: list[SessionSchema] = Field(description="The sessions of this page.")
    page: int = Field(description="Which page this is, from 1.")
    limit: int = Field(description="How many fit on a page.")
    next_page: int | None = Field(description="The next page; null after the last.")


class CalibrationDocument(BaseModel):
    """imu-calibration/1: parameters in SI with their full covariance."""

    format: str = Field(description="`imu-calibration/1`.")
    unit: str = Field(description="Serial number of the unit.")
    method: str = Field(description="How the parameters were estimated.")
    sensors: list[dict[str, Any]] = Field(
        description="Scale, bias, quadratic term and axis of every sensor, with total one-sigma uncertainties."
    )
    fit: dict[str, Any] = Field(description="χ², degrees of freedom, p-value, rank, weakest direction.")
    gauge: str = Field(description="What holds the block's frame.")
    covariance: dict[str, Any] = Field(description="Names and units of all elements; total and repeatability.")
    residuals: dict[str, Any] = Field(description="Measured minus modelled, row by row, at the input.")
