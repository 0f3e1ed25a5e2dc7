"""The tables of diagnoses and of those still to be made."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.storage.columns import IS_FAILED, Sentence, only_where
from service.storage.tables import Base


class DiagnosisRow(Base):
    """Diagnosis of a session: imu-diagnosis/1, deflated, or the reason why there is none."""

    __tablename__ = "diagnoses"
    __table_args__ = (Index("ix_diagnoses_failed", "state", **only_where(IS_FAILED)),)
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    model_revision: Mapped[int]
    state: Mapped[str] = mapped_column(String(20))
    summary: Mapped[str] = mapped_column(Sentence)
    gain_in_words: Mapped[str | None] = mapped_column(Sentence)
    """NULL where no cause is named, and of earlier releases."""
    document: Mapped[bytes | None]
    verdict_after: Mapped[str | None] = mapped_column(String(20))
    estimator_version: Mapped[str] = mapped_column(String(40))
    created_at: Mapped[datetime]
    reservations: Mapped[list[Any] | None] = mapped_column(JSON(none_as_null=True))
    """NULL where there are none, so that units with one are found."""
    tells: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
