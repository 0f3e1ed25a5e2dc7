"""When a unit must come back and why."""

from datetime import datetime
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from service.records.outlook import Action, DueRule


class FoundChangeSchema(BaseModel):
    """A change of one parameter that chance does not explain."""

    model_config = ConfigDict(from_attributes=True)

    kind: Literal["jump", "drift", "aging", "walk"] = Field(description="`walk`: it moved at no steady rate.")
    after: datetime = Field(description="The last session before it, or the first of all.")
    before: datetime = Field(description="The first session that shows it.")
    size: float = Field(
        description="SI or relative, of an axis its length; of a drift a year, of aging the first year's."
    )
    sigma: float = Field(description="Standard uncertainty of it.")
    p_value: float = Field(description="Over all kinds, sizes and times of change that were tried on the parameter.")


class TemperatureCoefficientSchema(BaseModel):
    """How a parameter follows the temperature of its sessions."""

    model_config = ConfigDict(from_attributes=True)

    value: float = Field(description="SI or relative per °C; of an axis its length.")
    sigma: float = Field(description="Standard uncertainty of it.")
    p_value: float = Field(description="Chance of one this far from zero when there is none.")
    is_found: bool = Field(description="Whether the trend goes on without it.")


class ParameterTrendSchema(BaseModel):
    """One parameter of one sensor since the unit's last break."""

    model_config = ConfigDict(from_attributes=True)

    sensor: str = Field(description="Name of the sensor.")
    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    parameter: str = Field(description="`scale`, `bias`, `quadratic`, `axis` or `misalignment`.")
    tolerance: float = Field(description="T, SI; relative for scale.")
    level: float = Field(description="Deviation at the last session, all sessions considered.")
    level_sigma: float = Field(description="Standard uncertainty of it.")
    rate_per_year: float = Field(description="Drift a year.")
    rate_sigma: float = Field(description="Standard uncertainty of it, that of the random walk included.")
    significance: float = Field(
        description="p-value: chance of changes as evident, of any kind and at any time, where nothing happens."
    )
    step_dates: list[datetime] = Field(description="Sessions that first showed a sudden change.")
    reach_50: datetime | None = Field(description="By then the tolerance is reached with 50 % probability.")
    reach_90: datetime | None = Field(description="Before it the tolerance is reached with 10 % probability only.")
    changes: list[FoundChangeSchema] = Field(description="Changes that chance does not explain, most evident first.")
    temperature: TemperatureCoefficientSchema | None = Field(
        description="How it follows the sessions' temperature; null where they do not span any."
    )
    population_z: float | None = Field(description="The rate among those of the type's units, in their robust spread.")


class RiskPointSchema(BaseModel):
    """The risk of waiting until a date."""

    model_config = ConfigDict(from_attributes=True)

    at: datetime = Field(description="Date, UTC.")
    risk: float = Field(description="Chance that any parameter has reached its tolerance by then.")


class DueBasisSchema(BaseModel):
    """The rule that set the date, with its parts."""

    model_config = ConfigDict(from_attributes=True)

    rule: DueRule = Field(description="The rule that decided.")
    at: datetime | None = Field(description="Of the session or the service that it starts from.")
    interval_days: float | None = Field(description="Longest interval, where the rule is one.")
    risk: float | None = Field(description="Chance of being out of tolerance at the date, where that set it.")
    sensor: str | None = Field(description="The sensor that adds most to that chance.")
    parameter: str | None = Field(description="Its parameter.")


class OutlookSchema(BaseModel):
    """When a unit must be calibrated next, why, and what waiting costs."""

    model_config = ConfigDict(from_attributes=True)

    serial: str = Field(description="Serial number.")
    unit_type: str = Field(description="Name of its type.")
    lot: str | None = Field(description="Production lot, where it is recorded.")
    due: datetime | None = Field(
        description="Next calibration: before the risk passes 5 %, never after the longest interval; null: at once."
    )
    action: Action = Field(description="What the unit needs next.")
    overdue: bool = Field(description="Whether that has passed.")
    reason: str = Field(description="Why then, in one sentence, made from `basis`.")
    basis: DueBasisSchema | None = Field(
        description="The rule that set the date; null in an outlook that an earlier version made, until it is renewed."
    )
    failed: str = Field(
        description="That it could not be worked out with the latest records, why and who must act; empty where it was."
    )
    sensor: str | None = Field(description="The sensor that reaches its tolerance first.")
    parameter: str | None = Field(description="Its parameter.")
    reach_50: datetime | None = Field(description="By then it is reached with 50 % probability.")
    reach_90: datetime | None = Field(description="Before it it is reached with 10 % probability only.")
    risk_at_due: float | None = Field(description="Chance that any parameter is out of tolerance by the due date.")
    until: RiskPointSchema | None = Field(description="The risk of waiting until the date that was asked for.")
    risk: list[RiskPointSchema] = Field(description="The risk of waiting, from the latest session on.")
    learned_from: int = Field(
        description="Histories of the type that the forecast rests on; 0 where it rests on units in general."
    )
    trends: list[ParameterTrendSchema] = Field(description="One a sensor and parameter.")
