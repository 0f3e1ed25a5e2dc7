"""The tables of units' conditions and of counts of the fleet."""

from datetime import datetime

from sqlalchemy import ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class ConditionRow(Base):
    """A unit's line on the fleet page: its latest session in short, rewritten with every upload."""

    __tablename__ = "conditions"
    __table_args__ = (
        Index("ix_conditions_worst_first", "severity", "margin", "unit_id"),
        Index("ix_conditions_stand_id_last_at", "stand_id", "last_at"),
    )
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    sessions: Mapped[int]
    last_session: Mapped[str] = mapped_column(ForeignKey("sessions.id"))
    severity: Mapped[int]
    margin: Mapped[float | None]
    flags: Mapped[int]
    last_at: Mapped[datetime | None] = mapped_column(index=True)
    stand_id: Mapped[int | None]


class UseRow(Base):
    """Permitted use of a unit, rewritten with its records; whether it fell due since is a question to the clock."""

    __tablename__ = "uses"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    answer: Mapped[str] = mapped_column(String(20), index=True)
    rank: Mapped[int]
    """Place of the answer in the order of attention, 0 first."""
    is_listed: Mapped[bool]
    """Whether the fleet counts it: in the register or measured, and not retired."""
    use: Mapped[str]
    """The answer in words, with what to do, in English."""


class TalliedRow(Base):
    """Contribution of a unit to the counts of the fleet, to be subtracted when the unit changes."""

    __tablename__ = "tallied"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    unit_type_id: Mapped[int]
    severity: Mapped[int]
    is_reference: Mapped[bool]
    is_simulated: Mapped[bool]
    bar: Mapped[int]
    flags: Mapped[int]
    reserved: Mapped[int]


class FleetTallyRow(Base):
    """Number of units of a type in one condition with one tenth of tolerance used; their open flags, and the number of
    their verdicts with a reservation.
    """

    __tablename__ = "fleet_tallies"
    unit_type_id: Mapped[int] = mapped_column(ForeignKey("unit_types.id"), primary_key=True, autoincrement=False)
    severity: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    is_reference: Mapped[bool] = mapped_column(primary_key=True)
    is_simulated: Mapped[bool] = mapped_column(primary_key=True)
    bar: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    """Tenth of the tolerance that the worst parameter uses, U included; the last one holds all beyond, −1 those of
    which nothing was judged."""
    units: Mapped[int]
    flags: Mapped[int]
    reserved: Mapped[int]
