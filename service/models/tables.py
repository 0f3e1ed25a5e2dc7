"""The tables of model revisions and recomputations."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.storage.tables import Base


class ModelRow(Base):
    """One cause accepted into the model of a unit, a unit type or a stand, or withdrawn from it; never changed."""

    __tablename__ = "model_revisions"
    __table_args__ = (Index("ix_model_revisions_scope", "scope", "subject", "id"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    scope: Mapped[str] = mapped_column(String(20))
    subject: Mapped[str] = mapped_column(String(200))
    cause: Mapped[str] = mapped_column(String(60))
    sensors: Mapped[list[Any]]
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), index=True)
    evidence: Mapped[Json]
    accepted_by: Mapped[str]
    note: Mapped[str]
    accepted_at: Mapped[datetime]
    withdraws: Mapped[int | None]


class RecomputationRow(Base):
    """Recomputation of a unit after a revision: its state, and the result."""

    __tablename__ = "recomputations"
    revision: Mapped[int] = mapped_column(ForeignKey("model_revisions.id"), primary_key=True, autoincrement=False)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    state: Mapped[str] = mapped_column(String(20))
    done_at: Mapped[datetime | None]
    outcome: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
