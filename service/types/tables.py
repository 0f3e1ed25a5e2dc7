"""The tables of unit types and the revisions of their tolerances."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.storage.tables import Base


class UnitTypeRow(Base):
    """A kind of unit; its tolerances are in `ToleranceRow`, where the largest revision is in force."""

    __tablename__ = "unit_types"
    id: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str] = mapped_column(String(200), unique=True)
    block: Mapped[str] = mapped_column(String(40))
    sensors: Mapped[list[Any]]
    nominal_axes: Mapped[list[Any]]
    nominal_scales: Mapped[list[Any]]
    revision: Mapped[int]
    maximum_interval_days: Mapped[float]
    flag_share: Mapped[float]


class ToleranceRow(Base):
    """One revision of a type's tolerances; never changed, so that past decisions keep theirs."""

    __tablename__ = "tolerance_revisions"
    unit_type_id: Mapped[int] = mapped_column(ForeignKey("unit_types.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True)
    since: Mapped[datetime]
    tolerances: Mapped[Json]
    gyro_tolerances: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
    are_entered: Mapped[bool]
    """Whether somebody entered them; else they are the defaults of each kind of sensor."""
    holds_before: Mapped[bool]
    """Whether they judge sessions from before them too."""
    temperature_laws: Mapped[list[Any] | None] = mapped_column(JSON(none_as_null=True))
    """`TypeLaw`, by which sessions are judged beside the tolerances; NULL where none hold."""
