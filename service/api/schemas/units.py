"""Units, unit types, tolerances, services, fleet."""

from datetime import datetime
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.events import ServiceSchema
from service.api.schemas.fields import Text
from service.api.schemas.reservations import SaidVerdict
from service.api.schemas.sessions import SessionSchema
from service.records.decision import Verdict

Tolerance = Annotated[float, Field(ge=1e-15, le=1e6, allow_inf_nan=False)]


class TolerancesSchema(BaseModel):
    """Largest allowed deviations from the reference; null where a parameter is not judged."""

    model_config = ConfigDict(from_attributes=True, extra="forbid")

    scale: Tolerance | None = Field(description="Relative: 1e-6 is 1 ppm.", examples=[1e-4])
    bias: Tolerance | None = Field(description="m/s² (rad/s).", examples=[4.9e-4])
    quadratic: Tolerance | None = Field(description="s²/m (s/rad).", examples=[2.04e-6])
    axis: Tolerance | None = Field(description="rad.", examples=[9.7e-5])


class NewTolerances(BaseModel):
    """Other tolerances for a unit type, from the next session on."""

    model_config = ConfigDict(extra="forbid")

    tolerances: TolerancesSchema = Field(description="Of the sensors of the block's own kind.")
    gyro_tolerances: TolerancesSchema | None = Field(
        default=None, description="Of the gyros of a block of accelerometers; null for the default ones."
    )
    maximum_interval_days: float | None = Field(
        default=None, ge=1, le=36_525, description="Longest time from a session to the next calibration; null keeps it."
    )


class VerdictChangeSchema(BaseModel):
    """A unit that would have another verdict."""

    model_config = ConfigDict(from_attributes=True)

    unit: str = Field(description="Serial number.")
    session: str = Field(description="Id of its latest session.")
    before: Verdict = Field(description="As it is stored.")
    after: Verdict = Field(description="Under the other tolerances.")
    sensor: str = Field(description="The sensor that it hangs on; empty where nothing would be judged.")
    parameter: str = Field(description="The parameter that it hangs on.")
    reason: str = Field(description="Why, in one sentence.")


class TolerancePreviewSchema(BaseModel):
    """What other tolerances would change."""

    model_config = ConfigDict(from_attributes=True)

    units: int = Field(description="Units of the type with a session that counts.")
    judged: int = Field(description="Those whose latest session was judged by the other tolerances.")
    references: int = Field(description="Those whose latest session is judged against nothing.")
    recordings: int = Field(
        description="Those whose latest session is a recording in service that no calibration stands beside."
    )
    beyond: int = Field(description="Those that were not looked at, because there are so many.")
    changes: list[VerdictChangeSchema] = Field(description="Units that would have another verdict, the worst first.")


class NewLot(BaseModel):
    """The production lot of a unit."""

    model_config = ConfigDict(extra="forbid")

    lot: Text | None = Field(description="Name of the lot; null where it is not known.", examples=["2024-07"])


class UnitTypeSchema(BaseModel):
    """A kind of unit: nominal axes and tolerances that all its units share."""

    model_config = ConfigDict(from_attributes=True)

    name: str = Field(description="Name of the type.")
    block: str = Field(description="`accelerometer` or `gyroscope`.")
    sensors: list[str] = Field(description="Names of the sensors.")
    nominal_axes: list[tuple[float, float, float]] = Field(description="Unit vectors in block axes.")
    nominal_scales: list[float] = Field(description="Reading unit per m/s² (rad/s).")
    tolerances: TolerancesSchema = Field(description="Of the sensors of the block's own kind.")
    gyro_tolerances: TolerancesSchema | None = Field(description="Of the gyros of a block of accelerometers.")
    revision: int = Field(description="Counts up with every change of tolerances; decisions name theirs.")
    maximum_interval_days: float = Field(description="Longest time from a session to the next calibration.")


class UnitTypePage(BaseModel):
    """One page of unit types, by name."""

    unit_types: list[UnitTypeSchema] = Field(description="The types of this page.")
    page: int = Field(description="Which page this is, from 1.")
    limit: int = Field(description="How many fit on a page.")
    next_page: int | None = Field(description="The next page; null after the last.")


class UnitSummarySchema(SaidVerdict):
    """One unit in short."""

    model_config = ConfigDict(from_attributes=True)

    serial: str = Field(description="Serial number.")
    unit_type: str = Field(description="Name of its type.")
    simulated: bool = Field(description="Whether its sessions were simulated, not measured.")
    sessions: int = Field(description="How many sessions are stored.")
    last_session: str | None = Field(description="Id of the latest session.")
    last_at: datetime | None = Field(description="When it was measured, UTC.")
    verdict: Verdict | None = Field(description="Of the latest session.")
    is_reference: bool = Field(description="Whether the latest session is one that later ones are judged against.")
    reason: str = Field(description="Why, in one sentence.")
    worst_sensor: str | None = Field(description="The sensor that the verdict hangs on.")
    worst_parameter: str | None = Field(description="The parameter that the verdict hangs on.")
    margin: float | None = Field(
        description="1 − (|d| + U)/T of it: 1 is spotless, 0 the edge of pass, negative beyond."
    )
    diagnosis: str = Field(description="What the simulation gets wrong about the latest session; empty if nothing.")
    flags: int = Field(description="How many flags are open.")
    due: datetime | None = Field(description="When its next calibration is due, UTC.")
    lot: str | None = Field(description="Production lot, where it is recorded.")
    last_at_ms: int | None = Field(description="`last_at` in milliseconds since 1970.")
    due_ms: int | None = Field(description="`due` in milliseconds since 1970.")


class UnitPage(BaseModel):
    """One page of units, worst first."""

    units: list[UnitSummarySchema] = Field(description="The units of this page.")
    page: int = Field(description="Which page this is, from 1.")
    limit: int = Field(description="How many fit on a page.")
    next_page: int | None = Field(description="The next page; null after the last.")


class FleetSchema(BaseModel):
    """The condition of the whole fleet."""

    model_config = ConfigDict(from_attributes=True)

    units: int = Field(description="How many units there are.")
    verdicts: dict[Verdict, int] = Field(description="How many of them have each verdict.")
    simulated: int = Field(description="How many of them were simulated, not measured.")
    flags: int = Field(description="How many flags are open.")
    reserved: dict[Verdict, int] = Field(description="Of how many with each verdict it is said with a reservation.")
    references: int = Field(
        description="Of how many the latest session is a reference, which nothing was held against."
    )


class UnitReportSchema(BaseModel):
    """Everything that is known of one unit, apart from its history."""

    model_config = ConfigDict(from_attributes=True)

    summary: UnitSummarySchema = Field(description="Its condition.")
    unit_type: UnitTypeSchema = Field(description="Its type, with the tolerances that hold now.")
    reference_session: str | None = Field(
        description="What the next session will be judged against; null when that one becomes the reference."
    )
    sessions: list[SessionSchema] = Field(description="The latest sessions, newest first.")
    services: list[ServiceSchema] = Field(description="All known breaks, oldest first.")
    withdrawn_services: list[ServiceSchema] = Field(description="Services that were withdrawn, oldest first.")
    waiting: int = Field(description="Sessions that are still to be judged again after a change of the records.")
