"""Shapes of units, types, the fleet and histories."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from service.fleet.condition import UnitSummary
from service.judging.covered import CoveredTemperatures
from service.judging.records import SaidVerdict, said
from service.judging.usable_reading import usable_of
from service.kit.answer import answer
from service.kit.copying import copied
from service.sessions.history_store import HistoryQuery
from service.sessions.records import HistoryPoint
from service.sessions.schemas import SaidSession, said_session
from service.storage.queries import Store
from service.types.records import UnitType
from service.units.records import Service
from service.web.fields import Body, Bound, Paged, Sought, Text, Window

Tolerance = Annotated[float, Field(ge=1e-15, le=1e6, allow_inf_nan=False)]


class TolerancesSchema(Body, from_attributes=True):
    """Largest allowed deviations from the reference; null where a parameter is not judged."""

    scale: Tolerance | None = Field(description="Relative: 1e-6 is 1 ppm.", examples=[1e-4])
    bias: Tolerance | None = Field(description="m/s² (rad/s).", examples=[4.9e-4])
    quadratic: Tolerance | None = Field(description="s²/m (s/rad).", examples=[2.04e-6])
    axis: Tolerance | None = Field(description="rad.", examples=[9.7e-5])


class NewTolerances(Body):
    """Other tolerances for a unit type, from the next session on."""

    tolerances: TolerancesSchema = Field(description="Of the sensors of the block's own kind.")
    gyro_tolerances: TolerancesSchema | None = Field(
        default=None, description="Of the gyros of a block of accelerometers; null for the default ones."
    )
    maximum_interval_days: float | None = Field(
        default=None, ge=1, le=36_525, description="Longest time from a session to the next calibration; null keeps it."
    )
    flag_share: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="Part of the tolerance from which on a change within it has a flag; null keeps it.",
    )
    stored_sessions: bool = Field(
        default=False, description="Whether the stored sessions are judged by them too; defaults are then confirmed."
    )


class NewLot(Body):
    """The production lot of a unit."""

    lot: Text | None = Field(description="Name of the lot; null where it is not known.", examples=["2024-07"])


class UnitTypePage(Paged):
    """One page of unit types, by name."""

    unit_types: tuple[UnitType, ...] = Field(description="The types of this page.")


@answer
@dataclass(frozen=True, kw_only=True)
class SaidUnit(SaidVerdict, UnitSummary):
    """One unit in short."""


def said_unit(unit: UnitSummary) -> SaidUnit:
    """The unit with its verdict in words."""
    return SaidUnit(**said(unit))


@answer
@dataclass(frozen=True, kw_only=True)
class UnitInUse(SaidUnit):
    """One unit in short, and whether it may be used."""

    usable: bool
    """Whether the unit may be used; false in doubt."""
    use: str
    """Permitted use in words, with the action."""


def units_in_use(store: Store, units: Sequence[UnitSummary], now: datetime) -> list[UnitInUse]:
    """Units with their permitted use, in their order."""
    uses = usable_of(store, units, now)
    return [UnitInUse(**said(unit), usable=uses[unit.serial].usable, use=uses[unit.serial].use) for unit in units]


class UnitPage(Paged):
    """One page of units, worst first."""

    units: list[UnitInUse] = Field(description="The units of this page.")


class UnitReportSchema(BaseModel):
    """Everything that is known of one unit, apart from its history."""

    model_config = ConfigDict(from_attributes=True)

    summary: UnitInUse = Field(description="Its condition, and whether it may be used.")
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
    temperatures_covered: CoveredTemperatures | None = Field(
        None, description="That its calibrations cover; null before the first of its epoch, or where none was recorded."
    )


Parameter = Literal[
    "scale", "bias", "quadratic", "axis", "misalignment",
    "quantisation", "white-noise", "bias-instability", "random-walk",
]  # fmt: skip
"""Parameters of a calibration, and the terms of noise at rest."""
TableForm = Literal["json", "csv", "parquet", "arrow"]


class HistoryAsked(BaseModel):
    """Part and form of a unit's history."""

    parameter: Parameter | None = Field(None, description="Only this parameter.")
    sensor: Sought | None = Field(None, description="Only this sensor.")
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
        """The query to the store."""
        return copied(HistoryQuery, self, offset=self.window.offset, newest=False, noise=None, kind=None)


class HistoryPage(Paged):
    """One page of a unit's history, oldest first."""

    unit: str = Field(description="Serial number of the unit.")
    points: tuple[HistoryPoint, ...] = Field(description="One a session, sensor and parameter.")
