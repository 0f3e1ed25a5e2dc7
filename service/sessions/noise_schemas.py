"""The noise of a session's sensors at rest."""

from pydantic import BaseModel, ConfigDict, Field


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
    """imu-noise/1: what the rests of a raw log say of its sensors."""

    format: str = Field(description="`imu-noise/1`.")
    rests: int = Field(description="How many rests.")
    longest_s: float = Field(description="The longest of them, s.")
    lasted_s: float = Field(description="All together, s.")
    sensors: list[SensorNoiseSchema] = Field(description="In the order of the session.")
