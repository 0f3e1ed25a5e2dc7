"""Stands and their own health."""

from datetime import datetime

from pydantic import BaseModel, ConfigDict, Field


class StandEvidenceSchema(BaseModel):
    """What the units say of one quantity on one stand."""

    model_config = ConfigDict(from_attributes=True)

    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    quantity: str = Field(description="`axes` or `scales`.")
    since: datetime = Field(description="First session that shows the shift, UTC.")
    until: datetime | None = Field(description="First session that shows it no more, UTC; null while it lasts.")
    value: list[float] = Field(description="Turn in block axes, rad, or relative change of all scales.")
    size: float = Field(description="Angle of the turn, or the relative change.")
    sigma: float = Field(description="Standard uncertainty of the size.")
    chi2: float = Field(description="How much better the units are explained with it than without, as chi-square.")
    p_value: float = Field(description="Chance of as much when nothing shifted, all dates and stands considered.")
    units: int = Field(description="Units that tell of it.")
    agreeing: int = Field(description="Of them, that show the shift.")
    has_shifted: bool = Field(description="Whether it counts as a shift of the stand.")


class StandSeatingSchema(BaseModel):
    """How blocks are seated on a stand, from one mounting to the next."""

    model_config = ConfigDict(from_attributes=True)

    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    quantity: str = Field(description="`axes` or `scales`.")
    tau: float = Field(description="Standard deviation per component: of a turn rad, of all scales relative.")


class StandSchema(BaseModel):
    """A stand as the units measured on it show it."""

    model_config = ConfigDict(from_attributes=True)

    stand: str = Field(description="Name of the stand.")
    sessions: int = Field(description="Sessions that it is judged by.")
    has_shifted: bool = Field(description="Whether it now shifts every unit that is measured on it.")
    reason: str = Field(description="In one sentence.")
    evidence: list[StandEvidenceSchema] = Field(description="Most evident, of every quantity that units tell of.")
    shifts: list[StandEvidenceSchema] = Field(description="Every shift, also one that was taken back; oldest first.")
    seating: list[StandSeatingSchema] = Field(description="Scatter of mountings, of every quantity.")
    unreadable: list[str] = Field(description="Sessions left out: what is stored of them cannot be used.")


class StandList(BaseModel):
    """All stands, by name."""

    stands: list[StandSchema] = Field(description="The stands.")
