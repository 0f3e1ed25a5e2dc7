"""The parameters of a unit through time."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import Bound, Text, Window
from service.records.decision import Verdict
from service.storage.queries.history import HistoryQuery

Parameter = Literal[
    "scale", "bias", "quadratic", "axis", "misalignment",
    "quantisation", "white-noise", "bias-instability", "random-walk",
]  # fmt: skip
"""What a calibration gives, and the terms of noise at rest."""
TableForm = Literal["json", "csv", "parquet", "arrow"]


class HistoryAsked(BaseModel):
    """Which part of a unit's history is wanted, and in which form."""

    parameter: Parameter | None = Field(None, description="Only this parameter.")
    sensor: Text | None = Field(None, description="Only this sensor.")
    since: Bound | None = Field(None, description="Measured at or after this time.")
    until: Bound | None = Field(None, description="Measured before this time.")
    format: TableForm | None = Field(
        None, description="Form of the answer; without it the header `Accept` chooses, else it is JSON."
    )
    revision: Annotated[int, Field(ge=0, le=2_000_000_000)] | None = Field(
        None, description="Under this model revision instead of the one in force; 0: baseline."
    )
    raw: bool = Field(False, description="Leave in what the whole block did: turn of all axes, factor of all scales.")
    page: int = Field(1, ge=1, le=1_000_000, description="Which page, from 1.")
    limit: int = Field(10_000, ge=1, le=50_000, description="How many points on a page.")

    @property
    def window(self) -> Window:
        """The page."""
        return Window(self.page, self.limit)

    @property
    def query(self) -> HistoryQuery:
        """The same for the store."""
        return HistoryQuery(
            parameter=self.parameter,
            sensor=self.sensor,
            since=self.since,
            until=self.until,
            offset=self.window.offset,
            limit=self.limit,
            revision=self.revision,
            raw=self.raw,
            noise=True,
        )


class HistoryPointSchema(BaseModel):
    """One parameter of one sensor at one session, ready for drawing a band."""

    model_config = ConfigDict(from_attributes=True)

    session: str = Field(description="Id of the session.")
    at: datetime = Field(description="When it was measured, UTC.")
    sensor: str = Field(description="Name of the sensor.")
    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    parameter: str = Field(
        description="`scale`, `bias`, `quadratic`, `axis`, `misalignment`, or a term of noise at rest."
    )
    value: float | None = Field(description="SI; for the axis the angle from the reference axis as judged, rad.")
    u: float | None = Field(description="Standard uncertainty of the value.")
    lower: float | None = Field(
        description="Value minus expanded uncertainty; of a term of noise the end of its 95 % interval."
    )
    upper: float | None = Field(
        description="Value plus expanded uncertainty; of a term of noise the end of its 95 % interval."
    )
    reference: float | None = Field(description="The value that it is judged against.")
    deviation: float | None = Field(description="From the reference, as it was judged: relative for scale, else SI.")
    expanded: float | None = Field(description="U of the deviation, of both sessions.")
    tolerance: float | None = Field(description="In the unit of the value; null where it is not judged.")
    verdict: Verdict = Field(description="The state of this parameter at this session.")
    is_reference: bool = Field(description="Whether the session is one that later ones are judged against.")
    axis: tuple[float, float, float] | None = Field(description="For the axis: its components in block axes.")
    revision: int = Field(description="Model revision that it was computed under; 0 is the baseline.")
    at_ms: int = Field(description="`at` in milliseconds since 1970.")


class HistoryPage(BaseModel):
    """One page of a unit's history, oldest first."""

    unit: str = Field(description="Serial number of the unit.")
    points: list[HistoryPointSchema] = Field(description="One a session, sensor and parameter.")
    page: int = Field(description="Which page this is, from 1.")
    limit: int = Field(description="How many points fit on a page.")
    next_page: int | None = Field(description="The next page; null after the last.")
