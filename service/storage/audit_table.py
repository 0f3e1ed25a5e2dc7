"""The table of the audit trail."""

from datetime import datetime
from typing import Any

from sqlalchemy import String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class AuditRow(Base):
    """Who did what when, each line with a hash of itself and of the one before; the database refuses to change it."""

    __tablename__ = "audit"
    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    who: Mapped[str]
    account: Mapped[str] = mapped_column(String(260), server_default="")
    action: Mapped[str] = mapped_column(String(40))
    subject: Mapped[str]
    details: Mapped[dict[str, Any]]
    hash: Mapped[str] = mapped_column(String(64), server_default="")
