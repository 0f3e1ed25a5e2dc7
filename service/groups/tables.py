"""Tables of the statistics of sessions for their groups and of joint diagnoses; all of them can be rebuilt.

A group is a unit, a unit type or a stand: ``level`` says which, ``group_id`` is its key in the table of that level.
"""

from datetime import datetime

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.columns import Sentence
from service.storage.tables import Base


class SessionStatisticsRow(Base):
    """Score and information of every cause that can last, of one session."""

    __tablename__ = "session_statistics"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    format: Mapped[str] = mapped_column(String(40))
    document: Mapped[bytes | None]
    """Statistics; None while they are being made, or where they cannot be."""
    why: Mapped[str] = mapped_column(Sentence)
    """Reason why they cannot be made; empty otherwise."""
    attempts: Mapped[int]
    """Number of times that they were begun: a process that dies of them reports nothing."""
    estimator_version: Mapped[str] = mapped_column(String(40))


class GroupDiagnosisRow(Base):
    """Joint diagnosis of a group's sessions, rewritten when one of them changes."""

    __tablename__ = "group_diagnoses"
    level: Mapped[str] = mapped_column(String(10), primary_key=True)
    group_id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    rests_on: Mapped[str] = mapped_column(String(64))
    """Digest of its sessions."""
    sessions: Mapped[int]
    summary: Mapped[str] = mapped_column(Sentence)
    own: Mapped[str] = mapped_column(Sentence)
    """Findings that belong to the group itself; empty for none."""
    document: Mapped[bytes | None]
    """imu-fleet-diagnosis/1; None where it could not be made."""
    estimator_version: Mapped[str] = mapped_column(String(40))
    created_at: Mapped[datetime]
