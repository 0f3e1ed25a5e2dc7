"""The table of long jobs."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, Index, String, false
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.storage.columns import BYTES, IS_AT_WORK, IS_FAILED, only_where
from service.storage.tables import Base


class JobRow(Base):
    """One job: its work, progress and result; its lease is in the queue."""

    __tablename__ = "jobs"
    __table_args__ = (
        Index("ix_jobs_open", "id", **only_where(IS_AT_WORK)),
        Index("ix_jobs_failed", "state", **only_where(IS_FAILED)),
    )
    id: Mapped[int] = mapped_column(primary_key=True)
    kind: Mapped[str] = mapped_column(String(20))
    scope: Mapped[str] = mapped_column(String(20))
    subject: Mapped[str] = mapped_column(String(200), index=True)
    form: Mapped[str] = mapped_column(String(10))
    language: Mapped[str] = mapped_column(String(10))
    revision: Mapped[int]
    who: Mapped[str]
    account: Mapped[str] = mapped_column(String(200), index=True)
    state: Mapped[str] = mapped_column(String(20))
    asked_at: Mapped[datetime]
    begun_at: Mapped[datetime | None]
    ended_at: Mapped[datetime | None]
    cancelled_by: Mapped[str]
    done: Mapped[int]
    total: Mapped[int]
    cursor: Mapped[int]
    recomputed: Mapped[int]
    verdicts: Mapped[int]
    failed: Mapped[int]
    failures: Mapped[list[Any]]
    filename: Mapped[str]
    size: Mapped[int] = mapped_column(BYTES)
    sha256: Mapped[str] = mapped_column(String(64))
    kept_until: Mapped[datetime | None]
    """Time until which its file is kept; NULL where there is none any more."""
    sent: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
    """Received file of an upload, as `Sent`; its hash is in ``sha256``."""
    is_storing: Mapped[bool] = mapped_column(server_default=false())
    """Whether the holder of the lease is storing the upload."""
    session: Mapped[str] = mapped_column(String(20), server_default="")
    refusal: Mapped[int | None]
