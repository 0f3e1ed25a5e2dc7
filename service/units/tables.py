"""The tables of units, services, custody, notes and attachments; the last three are append-only."""

from datetime import datetime

from sqlalchemy import ForeignKey, String, UniqueConstraint, false
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.columns import BYTES
from service.storage.tables import Base


class UnitRow(Base):
    """One physical IMU."""

    __tablename__ = "units"
    id: Mapped[int] = mapped_column(primary_key=True)
    serial: Mapped[str] = mapped_column(String(200), unique=True)
    unit_type_id: Mapped[int] = mapped_column(ForeignKey("unit_types.id"), index=True)
    simulated: Mapped[bool]
    is_demonstration: Mapped[bool] = mapped_column(server_default=false())
    """Whether nobody but the demonstration uploaded a session of it."""
    lot: Mapped[str | None] = mapped_column(String(200))
    customer: Mapped[str] = mapped_column(String(200), server_default="")
    customer_address: Mapped[str] = mapped_column(String(2000), server_default="")
    owner: Mapped[str] = mapped_column(String(200), server_default="")
    location: Mapped[str] = mapped_column(String(200), server_default="")
    custodian: Mapped[str] = mapped_column(String(200), server_default="")
    remark: Mapped[str] = mapped_column(String(2000), server_default="")
    registered_at: Mapped[datetime | None]
    """Time of entry in the register; None for a unit that came with its first session only."""
    retired_at: Mapped[datetime | None]


class CustodyRow(Base):
    """Step of a unit in the register: its location and custodian from then on; never changed."""

    __tablename__ = "custody"
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), index=True)
    at: Mapped[datetime]
    recorded_at: Mapped[datetime]
    who: Mapped[str] = mapped_column(String(200))
    step: Mapped[str] = mapped_column(String(20))
    location_before: Mapped[str] = mapped_column(String(200))
    location: Mapped[str] = mapped_column(String(200))
    custodian_before: Mapped[str] = mapped_column(String(200))
    custodian: Mapped[str] = mapped_column(String(200))
    remark: Mapped[str] = mapped_column(String(2000))


class ServiceRow(Base):
    """A known break in a unit's history."""

    __tablename__ = "services"
    __table_args__ = (UniqueConstraint("unit_id", "at", "kind", "sensor"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"))
    at: Mapped[datetime]
    kind: Mapped[str] = mapped_column(String(40))
    note: Mapped[str]
    recorded_at: Mapped[datetime]
    who: Mapped[str]
    sensor: Mapped[str] = mapped_column(String(200))
    state: Mapped[str] = mapped_column(String(20), default="accepted")


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
    """Session of the note, if it is on one; without a foreign key, which on SQLite would require rebuilding the
    table.
    """


class WithdrawalRow(Base):
    """Withdrawal of a note; append-only too."""

    __tablename__ = "note_withdrawals"
    note_id: Mapped[int] = mapped_column(ForeignKey("notes.id"), primary_key=True, autoincrement=False)
    at: Mapped[datetime]
    who: Mapped[str]
    why: Mapped[str]


class AttachmentRow(Base):
    """An attached file; its bytes are stored under their hash, like uploads."""

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
    """Withdrawal of an attached file."""

    __tablename__ = "attachment_withdrawals"
    attachment_id: Mapped[int] = mapped_column(ForeignKey("attachments.id"), primary_key=True, autoincrement=False)
    at: Mapped[datetime]
    who: Mapped[str]
    why: Mapped[str]
