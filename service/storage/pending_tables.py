"""The tables of what is still to be made, and of why that failed; a line goes when it is made."""

from datetime import UTC, datetime

from sqlalchemy import ForeignKey, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base

NEVER = datetime(9999, 1, 1, tzinfo=UTC)
"""Until when nobody is at what was given up."""


class PendingRow(Base):
    """A session that waits for its diagnosis, and who is at it."""

    __tablename__ = "pending_diagnoses"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    asked_at: Mapped[datetime] = mapped_column(index=True)
    ticket: Mapped[str] = mapped_column(String(32))
    """Another one whenever what the diagnosis looks at changes: what was made under an older one is not stored."""
    not_before: Mapped[datetime | None]
    """After a try that failed, until the next one."""
    claimed_by: Mapped[str | None] = mapped_column(String(32))
    claimed_until: Mapped[datetime | None]
    attempts: Mapped[int]
    """Claims that ended without a word: the process died."""
    failed: Mapped[str | None] = mapped_column(Text)
    """Why the last try failed; NULL where none did."""


class PendingOutlookRow(Base):
    """A unit whose outlook is to be worked out again, and until when somebody is at it."""

    __tablename__ = "pending_outlooks"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    asked_at: Mapped[datetime]
    ticket: Mapped[str] = mapped_column(String(32))
    """Another one whenever the unit's history changes: what was made under an older one is made again."""
    claimed_until: Mapped[datetime | None]
    """`NEVER` where no process outlived it: then it waits for the unit's history to change, or for another start."""
    attempts: Mapped[int]
    """Claims that ended without a word: the process died."""
    failed: Mapped[str | None] = mapped_column(Text)
    """Why the last try failed; NULL where none did."""


class FailedDerivationRow(Base):
    """A unit whose sessions could not be judged again after its records changed, and why."""

    __tablename__ = "failed_derivations"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    failed: Mapped[str] = mapped_column(Text)
