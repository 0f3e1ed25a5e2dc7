"""What is kept of the fleet as a whole, so that no page works it out: counts, which follow every record within its own
transaction, and what types and stands show, which is asked for there and made beside the requests. All of it is a
function of the other tables and can be made again.

    tallied       ──> fleet_tallies     what every unit adds to the counts, and the counts
    stand_units   ──> stand_tallies     the same by stand
    work ──> populations, stand_conditions
"""

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class TalliedRow(Base):
    """What a unit adds to the counts of the fleet: it says what to take off when the unit changes."""

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
    """How many units of a type are in one condition and use so much of their tolerance; their open flags, and how many
    of their verdicts are said with a reservation."""

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


class StandUnitRow(Base):
    """How many accepted sessions of a unit were measured on a stand."""

    __tablename__ = "stand_units"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    sessions: Mapped[int]


class StandTallyRow(Base):
    """How many accepted sessions were measured on a stand, of how many units."""

    __tablename__ = "stand_tallies"
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    sessions: Mapped[int]
    units: Mapped[int]


class PopulationRow(Base):
    """How the units of a type drift in one parameter: centre and spread of their rates, and who is far out."""

    __tablename__ = "populations"
    __table_args__ = (
        Index("ix_populations_furthest", "furthest"),
        Index("ix_populations_furthest_lot", "furthest_lot"),
        Index("ix_populations_most_evident", "most_evident"),
    )
    unit_type_id: Mapped[int] = mapped_column(ForeignKey("unit_types.id"), primary_key=True, autoincrement=False)
    kind: Mapped[str] = mapped_column(String(20), primary_key=True)
    parameter: Mapped[str] = mapped_column(String(20), primary_key=True)
    centre: Mapped[float]
    spread: Mapped[float]
    rates: Mapped[int]
    """That it is of: one a sensor."""
    lots: Mapped[int]
    """Production lots that were set against it."""
    furthest: Mapped[float]
    """Distance of the unit that is furthest out of those that drift fast enough to matter; 0 without one."""
    furthest_lot: Mapped[float]
    most_evident: Mapped[float]
    """Distance of the unit that is furthest out of those whose drift chance does not explain."""
    far: Mapped[dict[str, Any]]
    """The furthest units and lots."""
    made_at: Mapped[datetime]


class StandConditionRow(Base):
    """A stand's own health, as the units measured on it show it."""

    __tablename__ = "stand_conditions"
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    shifts: Mapped[int]
    """How many are known, those that were taken back too."""
    document: Mapped[dict[str, Any]]
    made_at: Mapped[datetime]
