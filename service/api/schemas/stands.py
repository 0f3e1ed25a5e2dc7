"""Stands and their own health."""

from datetime import datetime

from pydantic import BaseModel, ConfigDict, Field


class StandEvidenceSchema(BaseModel):
    """What the units say of one quantity on one stand."""

    model_config = ConfigDict(from_attributes=True)

    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    quantity: str = Field(description="`axes` or `scales`.")
    since: datetime = Field(description="First session of the most evident shift, UTC.")
    value: list[float] = Field(description="Turn in block axes, rad, or relative change of all scales.")
    size: float = Field(description="Angle of the turn, or the relative change.")
    sigma: float = Field(description="Standard uncertainty of the size.")
    p_value: float = Field(description="Chance of as much when nothing shifted, all dates and stands considered.")
    units: int = Field(description="Units that tell of it.")
    agreeing: int = Field(description="Of them, that show the shift.")
    has_shifted: bool = Field(description="Whether it counts as a shift of the stand.")


class StandSchema(BaseModel):
    """A stand as the units measured on it show it."""

    model_config = ConfigDict(from_attributes=True)

    stand: str = Field(description="Name of the stand.")
    sessions: int = Field(description="Sessions that it is judged by.")
    has_shifted: bool = Field(description="Whether it shifts every unit that is measured on it.")
    reason: str = Field(description="In one sentence.")
    evidence: list[StandEvidenceSchema] = Field(description="Of every quantity that three or more units tell of.")
    unreadable: list[str] = Field(description="Sessions left out: what is stored of them cannot be used.")


class StandList(BaseModel):
    """All stands, by name."""

    stands: list[StandSchema] = Field(description="The stands.")
