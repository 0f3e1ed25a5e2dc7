"""The tables of flags, notices, webhooks and deliveries."""

from datetime import datetime

from sqlalchemy import ForeignKey, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.columns import IS_FAILED, IS_OPEN, IS_WAITING, Sentence, only_where
from service.storage.tables import Base


class FlagRow(Base):
    """A matter that somebody must look after, as its notices left it; of one matter only one flag is open."""

    __tablename__ = "flags"
    __table_args__ = (
        Index("ix_flags_unit_id", "unit_id", "id"),
        Index("ix_flags_state", "state", "id"),
        Index("ix_flags_open", "id", **only_where(IS_OPEN)),
        Index("uq_flags_open", "unit_id", "matter", "place", unique=True, **only_where(IS_OPEN)),
    )
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"))
    matter: Mapped[str] = mapped_column(String(20))
    place: Mapped[str] = mapped_column(String(200))
    state: Mapped[str] = mapped_column(String(20))
    severity: Mapped[int]
    summary: Mapped[str] = mapped_column(Sentence)
    proposal: Mapped[str] = mapped_column(Sentence)
    session_id: Mapped[str | None] = mapped_column(ForeignKey("sessions.id"))
    raised_at: Mapped[datetime]
    changed_at: Mapped[datetime]
    assignee: Mapped[str] = mapped_column(String(200), server_default="")
    assignee_login: Mapped[str] = mapped_column(String(60), server_default="")
    scope: Mapped[str] = mapped_column(String(10), server_default="unit")
    subject: Mapped[str] = mapped_column(String(200), server_default="")


class NoticeRow(Base):
    """Event of a flag or of a unit's verdict, with its time and person; append-only."""

    __tablename__ = "notices"
    __table_args__ = (Index("ix_notices_flag_id", "flag_id", "id"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"))
    flag_id: Mapped[int | None] = mapped_column(ForeignKey("flags.id"))
    kind: Mapped[str] = mapped_column(String(20))
    at: Mapped[datetime]
    who: Mapped[str]
    text: Mapped[str] = mapped_column(Sentence)
    session_id: Mapped[str | None] = mapped_column(ForeignKey("sessions.id"))


class WebhookRow(Base):
    """An address that is notified; one that was removed keeps its deliveries."""

    __tablename__ = "webhooks"
    id: Mapped[int] = mapped_column(primary_key=True)
    url: Mapped[str]
    secret: Mapped[str]
    who: Mapped[str]
    created_at: Mapped[datetime]
    removed_at: Mapped[datetime | None]


class DeliveryRow(Base):
    """One notice on its way to one address; the queue knows when it is sent next."""

    __tablename__ = "deliveries"
    __table_args__ = (
        UniqueConstraint("webhook_id", "notice_id"),
        Index("ix_deliveries_waiting", "id", **only_where(IS_WAITING)),
        Index("ix_deliveries_failed", "state", **only_where(IS_FAILED)),
    )
    id: Mapped[int] = mapped_column(primary_key=True)
    notice_id: Mapped[int] = mapped_column(ForeignKey("notices.id"))
    webhook_id: Mapped[int] = mapped_column(ForeignKey("webhooks.id"))
    state: Mapped[str] = mapped_column(String(20))
    attempts: Mapped[int]
    """Number of attempts."""
    ended_at: Mapped[datetime | None]
    outcome: Mapped[str]
