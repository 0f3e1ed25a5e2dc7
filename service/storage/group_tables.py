"""The tables of what sessions tell of their groups and of what groups show; all of them can be rebuilt.

A group is a unit, a unit type or a stand: ``level`` says which, ``group_id`` is its key in the table of that level.
"""

from datetime import datetime

from sqlalchemy import ForeignKey, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class SessionStatisticsRow(Base):
    """Score and information of every cause that can last, of one session."""

    __tablename__ = "session_statistics"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    format: Mapped[str] = mapped_column(String(40))
    document: Mapped[bytes | None]
    """None while they are being made, or where they cannot be."""
    why: Mapped[str]
    """They cannot be made; empty else."""
    attempts: Mapped[int]
    """How often they were begun: a process that dies of them says nothing."""
    estimator_version: Mapped[str] = mapped_column(String(40))


class GroupDiagnosisRow(Base):
    """What the sessions of a group show together, rewritten when one of them changes."""

    __tablename__ = "group_diagnoses"
    level: Mapped[str] = mapped_column(String(10), primary_key=True)
    group_id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    rests_on: Mapped[str] = mapped_column(String(64))
    """Digest of its sessions."""
    sessions: Mapped[int]
    summary: Mapped[str]
    own: Mapped[str]
    """Of what they show, that which is of the group itself; empty for nothing."""
    document: Mapped[bytes | None]
    """None where it could not be made."""
    estimator_version: Mapped[str] = mapped_column(String(40))
    created_at: Mapped[datetime]


class AskedRow:
    """Somebody asks for what a group shows, because a session of it changed.

    Every asking is a row of its own: so none waits for another, whatever else both of them hold.
    """

    id: Mapped[int] = mapped_column(primary_key=True)
    level: Mapped[str] = mapped_column(String(10))
    group_id: Mapped[int]
    asked_at: Mapped[datetime]
    claimed_until: Mapped[datetime | None]
    attempts: Mapped[int]
    failed: Mapped[str | None] = mapped_column(Text)
    """Why the last try failed; NULL where none did."""


class PendingGroupRow(AskedRow, Base):
    """For what its sessions show together."""

    __tablename__ = "pending_groups"
    __table_args__ = (Index("ix_pending_groups_level_group_id", "level", "group_id"),)


class PendingSummaryRow(AskedRow, Base):
    """Of a unit type for how its units drift, of a stand for its own health."""

    __tablename__ = "pending_summaries"
    __table_args__ = (Index("ix_pending_summaries_level_group_id", "level", "group_id"),)
