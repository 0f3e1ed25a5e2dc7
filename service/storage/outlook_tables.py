"""The tables of what lies ahead of a unit and of what its histories tell of their type; both can be rebuilt."""

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class OutlookRow(Base):
    """When a unit must come back and why, rewritten when its history changes: drift, forecast, risk."""

    __tablename__ = "outlooks"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    due: Mapped[datetime | None] = mapped_column(index=True)
    reason: Mapped[str]
    """Why then, in one sentence."""
    rates: Mapped[list[Any]]
    """How every parameter drifts, for the type: ``[sensor, kind, parameter, rate, sigma, significance, tolerance]``."""
    document: Mapped[dict[str, Any]]
    drawn: Mapped[dict[str, Any]]


class HistoryRow(Base):
    """What a unit's histories of one parameter tell of its type, without their sessions."""

    __tablename__ = "histories"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True)
    kind: Mapped[str] = mapped_column(String(20), primary_key=True)
    parameter: Mapped[str] = mapped_column(String(20), primary_key=True)
    evidence: Mapped[bytes]
