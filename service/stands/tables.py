"""The tables of stands: the effects that units show, the stands' conditions and certificates."""

from datetime import date, datetime

from sqlalchemy import JSON, ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.storage.tables import Base


class StandRow(Base):
    """A stand that sessions were measured on."""

    __tablename__ = "stands"
    id: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str] = mapped_column(String(200), unique=True)


class StandUnitRow(Base):
    """Number of accepted sessions of a unit on a stand."""

    __tablename__ = "stand_units"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    sessions: Mapped[int]


class StandTallyRow(Base):
    """Number of accepted sessions on a stand, and of their units."""

    __tablename__ = "stand_tallies"
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    sessions: Mapped[int]
    units: Mapped[int]


class StandConditionRow(Base):
    """A stand's own health, as the units measured on it show it."""

    __tablename__ = "stand_conditions"
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    shifts: Mapped[int]
    """Number of known shifts, ended ones included."""
    document: Mapped[Json]
    made_at: Mapped[datetime]


class StandCertificateRow(Base):
    """A certificate of a stand as it was recorded; of one number the latest row holds. Append-only."""

    __tablename__ = "stand_certificates"
    id: Mapped[int] = mapped_column(primary_key=True)
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), index=True)
    number: Mapped[str] = mapped_column(String(200))
    issued_by: Mapped[str] = mapped_column(String(200))
    issued_on: Mapped[date]
    valid_until: Mapped[date]
    errors: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
    """Standard uncertainty of every error that its document states, rad; null where it was recorded by hand."""
    who: Mapped[str]
    recorded_at: Mapped[datetime]
