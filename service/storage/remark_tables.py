"""The tables of what people say of units and sessions; append-only."""

from datetime import datetime

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.columns import BYTES
from service.storage.tables import Base


class NoteRow(Base):
    """A remark on a unit's history; the database itself refuses to change or delete one."""

    __tablename__ = "notes"
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), index=True)
    at: Mapped[datetime]
    text: Mapped[str]
    who: Mapped[str]
    recorded_at: Mapped[datetime]
    session_id: Mapped[str | None] = mapped_column(String(20), index=True)
    """Of a remark on a session; without a constraint, for on SQLite that would make the table anew."""


class WithdrawalRow(Base):
    """Why a note no longer holds; append-only too."""

    __tablename__ = "note_withdrawals"
    note_id: Mapped[int] = mapped_column(ForeignKey("notes.id"), primary_key=True, autoincrement=False)
    at: Mapped[datetime]
    who: Mapped[str]
    why: Mapped[str]


class AttachmentRow(Base):
    """A file that somebody attached; its bytes lie under their hash, as uploads do."""

    __tablename__ = "attachments"
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), index=True)
    session_id: Mapped[str | None] = mapped_column(ForeignKey("sessions.id"), index=True)
    sha256: Mapped[str] = mapped_column(String(64))
    filename: Mapped[str]
    size: Mapped[int] = mapped_column(BYTES)
    text: Mapped[str]
    who: Mapped[str]
    at: Mapped[datetime]


class AttachmentWithdrawalRow(Base):
    """Why an attached file is no longer given out."""

    __tablename__ = "attachment_withdrawals"
    attachment_id: Mapped[int] = mapped_column(ForeignKey("attachments.id"), primary_key=True, autoincrement=False)
    at: Mapped[datetime]
    who: Mapped[str]
    why: Mapped[str]
