"""The tables of outlooks, of histories, and of how the units of types drift.

transaction, and what types and stands show, which is asked for there and made in the background. All of it is a
function of the other tables and can be made again.

    tallied       ──> fleet_tallies     what every unit adds to the counts, and the counts
    stand_units   ──> stand_tallies     the same by stand
    work ──> populations, stand_conditions
"""

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.storage.columns import Sentence
from service.storage.tables import Base


class OutlookRow(Base):
    """Next calibration of a unit and its reason, rewritten when its history changes: drift, forecast, risk."""

    __tablename__ = "outlooks"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    due: Mapped[datetime | None] = mapped_column(index=True)
    reason: Mapped[str] = mapped_column(Sentence)
    """Reason for the date, in one sentence."""
    rates: Mapped[list[Any]]
    """Drift of every parameter, for the type: ``[sensor, kind, parameter, rate, sigma, significance, tolerance]``."""
    document: Mapped[Json]
    drawn: Mapped[Json]


class HistoryRow(Base):
    """Evidence on the type from a unit's histories of one parameter, without their sessions."""

    __tablename__ = "histories"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True)
    kind: Mapped[str] = mapped_column(String(20), primary_key=True)
    parameter: Mapped[str] = mapped_column(String(20), primary_key=True)
    evidence: Mapped[bytes]


class PopulationRow(Base):
    """Drift of the units of a type in one parameter: centre and spread of their rates, and the units far out."""

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
    """Number of rates: one a sensor."""
    lots: Mapped[int]
    """Production lots that were set against it."""
    furthest: Mapped[float]
    """Distance of the unit that is furthest out of those that drift fast enough to matter; 0 without one."""
    furthest_lot: Mapped[float]
    most_evident: Mapped[float]
    """Distance of the unit that is furthest out of those whose drift chance does not explain."""
    far: Mapped[Json]
    """The furthest units and lots."""
    made_at: Mapped[datetime]
