"""The table of work beside the requests that is still to be done; a row goes when it is done."""

from datetime import datetime

from sqlalchemy import Index, String, text
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.columns import LongSentence, only_where
from service.storage.tables import Base

IS_SINGLE = "kind NOT IN ('group', 'summary')"
"""Kinds with one row a piece. Who asks for a group inserts a row of its own: uploads of different units ask for the
same group, and none waits for the transaction of another."""
SINGLE = text(IS_SINGLE)


class WorkRow(Base):
    """A piece of work that somebody asked for, and who is at it."""

    __tablename__ = "work"
    __table_args__ = (
        Index("uq_work_single", "kind", "key", unique=True, **only_where(IS_SINGLE)),
        Index("ix_work_kind_key", "kind", "key"),
        Index("ix_work_kind_asked_at", "kind", "asked_at"),
    )
    id: Mapped[int] = mapped_column(primary_key=True)
    kind: Mapped[str] = mapped_column(String(20))
    key: Mapped[str] = mapped_column(String(250))
    """Of what it is, as `WorkKind` says."""
    asked_at: Mapped[datetime]
    """Its place in the line; of what was tried in vain or is done in part, when that was."""
    ticket: Mapped[str] = mapped_column(String(32))
    """Another one whenever what the work looks at changes: what was made under an older one is not stored."""
    state: Mapped[str] = mapped_column(String(10))
    not_before: Mapped[datetime | None]
    """After a try that failed, until the next one."""
    lease_until: Mapped[datetime | None]
    """Until when nobody else begins it; NULL where nobody is at it."""
    attempts: Mapped[int]
    """Leases that ended without an answer, as when the process died."""
    failed: Mapped[str | None] = mapped_column(LongSentence)
    """Why the last try failed; NULL where none did."""
