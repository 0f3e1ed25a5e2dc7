"""The table of pending background work; a row is removed when its work is done."""

from datetime import datetime

from sqlalchemy import Index, String, text
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.columns import LongSentence, only_where
from service.storage.tables import Base

IS_SINGLE = "kind NOT IN ('group', 'summary')"
"""Kinds with one row a piece. Each request of a group inserts its own row: uploads of different units request the same
group, and none waits for the transaction of another."""
SINGLE = text(IS_SINGLE)


class WorkRow(Base):
    """A requested piece of work and its lease."""

    __tablename__ = "work"
    __table_args__ = (
        Index("uq_work_single", "kind", "key", unique=True, **only_where(IS_SINGLE)),
        Index("ix_work_kind_key", "kind", "key"),
        Index("ix_work_kind_asked_at", "kind", "asked_at"),
        Index("ix_work_rank_asked_at", "rank", "asked_at"),
    )
    id: Mapped[int] = mapped_column(primary_key=True)
    kind: Mapped[str] = mapped_column(String(20))
    key: Mapped[str] = mapped_column(String(250))
    """Identifies the work, see `WorkKind`."""
    rank: Mapped[int] = mapped_column(server_default="1")
    """See `Rank`."""
    asked_at: Mapped[datetime]
    """Position among work of the same rank: time of the request, or of the last failed or partial attempt."""
    ticket: Mapped[str] = mapped_column(String(32))
    """Changes whenever the input of the work changes: a result made under an older ticket is not stored."""
    state: Mapped[str] = mapped_column(String(10))
    not_before: Mapped[datetime | None]
    """Time of the next attempt after a failed one."""
    lease_until: Mapped[datetime | None]
    """Lease expiry; NULL where unclaimed."""
    attempts: Mapped[int]
    """Leases that ended without an answer, as when the process died."""
    failed: Mapped[str | None] = mapped_column(LongSentence)
    """Reason of the last failed attempt; NULL where none failed."""
