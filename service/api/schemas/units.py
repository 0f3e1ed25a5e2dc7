"""Units, unit types, tolerances, services, fleet."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from service.api.schemas.fields import Paged, Text
from service.api.schemas.reservations import SaidVerdict, said
from service.api.schemas.sessions import SaidSession, said_session
from service.records.answer import answer
from service.records.event import Service
from service.records.unit import UnitSummary, UnitType

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


class NewLot(BaseModel):
    """The production lot of a unit."""

    model_config = ConfigDict(extra="forbid")

    lot: Text | None = Field(description="Name of the lot; null where it is not known.", examples=["2024-07"])


class UnitTypePage(Paged):
    """One page of unit types, by name."""

    unit_types: tuple[UnitType, ...] = Field(description="The types of this page.")


@answer
@dataclass(frozen=True, kw_only=True)
class SaidUnit(SaidVerdict, UnitSummary):
    """One unit in short."""


def said_unit(unit: UnitSummary) -> SaidUnit:
    """With its verdict in words."""
    return SaidUnit(**said(unit))


class UnitPage(Paged):
    """One page of units, worst first."""

    units: list[SaidUnit] = Field(description="The units of this page.")


class UnitReportSchema(BaseModel):
    """Everything that is known of one unit, apart from its history."""

    model_config = ConfigDict(from_attributes=True)

    summary: Annotated[SaidUnit, BeforeValidator(said_unit)] = Field(description="Its condition.")
    unit_type: UnitType = Field(description="Its type, with the tolerances that hold now.")
    reference_session: str | None = Field(
        description="What the next session will be judged against; null when that one becomes the reference."
    )
    sessions: list[Annotated[SaidSession, BeforeValidator(said_session)]] = Field(
        description="The latest sessions, newest first."
    )
    services: list[Service] = Field(description="All known breaks, oldest first.")
    withdrawn_services: list[Service] = Field(description="Services that were withdrawn, oldest first.")
    waiting: int = Field(description="Sessions that are still to be judged again after a change of the records.")
