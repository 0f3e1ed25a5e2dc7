"""Shapes of corrections, signatures and traceability."""

from datetime import datetime

from pydantic import BaseModel, Field

from estimator.json_object import Json
from service.judging.covered import CoveredTemperatures
from service.papers.records import Meaning
from service.sessions.decision import Verdict
from service.web.fields import Body, LongText, Name, Text


class BlockCorrectionSchema(BaseModel):
    """The sensors of one kind, and the matrix that joins them."""

    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    gives: str = Field(description="What comes out, its unit and axes.")
    sensors: list[Json] = Field(
        description="Of each sensor `offset`, `count_time`, `scale`, `bias`, `quadratic`, `axis` and their units."
    )
    matrix: list[list[float]] = Field(description="Three rows, one column a sensor: least squares of the components.")
    example: Json = Field(
        description="The session's first row, step by step in numbers and words; the uncertainty is the calibration's."
    )


class CorrectionDocument(BaseModel):
    """imu-correction/1: how readings become specific force and angular rate. SI."""

    format: str = Field(description="`imu-correction/1`.")
    unit: str = Field(description="Serial number of the unit.")
    session: str = Field(description="Id of the session.")
    sha256: str = Field(description="SHA-256 of its file.")
    measured_at: datetime = Field(description="When it was measured, with the offset from UTC that the file states.")
    verdict: Verdict = Field(description="Of the session: a unit that failed can be corrected, but should it be used?")
    simulated: bool = Field(description="Whether it was simulated, not measured.")
    method: str = Field(description="How the parameters were estimated.")
    model_revision: int = Field(description="Model revision in force; 0 is the baseline.")
    frame: str = Field(description="The axes of the result, and what holds them.")
    software: str = Field(description="What computed it.")
    reference_temperature_c: float | None = Field(
        None,
        description="Of a thermal session: T₀ of `scale_over_temperature` and `bias_over_temperature` of a sensor.",
    )
    temperature_range_c: tuple[float, float] | None = Field(None, description="Where they hold; null without them.")
    formula: list[str] = Field(description="The steps from a reading to the vector.")
    blocks: list[BlockCorrectionSchema] = Field(description="One a kind of sensor.")
    left_out: list[dict[str, str]] = Field(description="Sensors that cannot be corrected, and why.")
    not_corrected: list[str] = Field(description="What the formula leaves in the readings.")
    extended_model: list[Json] = Field(
        description="Accepted causes in force: the parameters are free of them, the formula does not correct them."
    )
    temperature_laws: list[Json] = Field(
        description="What the session's temperature is worth, by the unit's law; the formula does not correct it."
    )
    temperatures_covered: CoveredTemperatures | None = Field(
        None, description="That the unit's calibrations up to this one cover; null where the reference says none."
    )


class NewCustomer(Body):
    """Customer of a unit, and the person who states it."""

    name: Text = Field(default="", description="Empty where it is not stated.", examples=["Aero Works Ltd"])
    address: LongText = Field(default="", description="Where they can be reached.", examples=["1 Hangar Road, Derby"])
    by: Text = Field(default="crew", description="Your name.")


class NewSignature(Body):
    """A name that is to stand under a certificate."""

    number: Name = Field(description="Of the certificate that you read; one that is not the latest is refused.")
    meaning: Meaning = Field(description="A certificate is reviewed first, and approved by somebody else.")
    password: str = Field(max_length=1000, description="Of your account, asked again.")
