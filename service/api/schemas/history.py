"""The parameters of a unit through time."""

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from service.api.schemas.fields import Bound, Paged, Text, Window
from service.records.history import HistoryPoint
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


class HistoryPage(Paged):
    """One page of a unit's history, oldest first."""

    unit: str = Field(description="Serial number of the unit.")
    points: tuple[HistoryPoint, ...] = Field(description="One a session, sensor and parameter.")
