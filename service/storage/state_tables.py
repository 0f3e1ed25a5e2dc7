"""The tables of what became of records; the others are in `tables`."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class RecordStateRow(Base):
    """What became of a session or a service, by whom, when and why; append-only, the last line is its state."""

    __tablename__ = "record_states"
    __table_args__ = (Index("ix_record_states_record", "kind", "record", "id"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    kind: Mapped[str] = mapped_column(String(20))
    record: Mapped[str] = mapped_column(String(20))
    state: Mapped[str] = mapped_column(String(20))
    who: Mapped[str]
    at: Mapped[datetime]
    why: Mapped[str]
    superseded_by: Mapped[str | None] = mapped_column(String(20))
    remedies: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))


class ReferenceChoiceRow(Base):
    """A session that an engineer chose as the reference of its epoch; append-only, the last one that holds is used."""

    __tablename__ = "reference_choices"
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), index=True)
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"))
    who: Mapped[str]
    at: Mapped[datetime]
    why: Mapped[str]
