"""The table of what is remembered of people's own layouts. Append-only: of one layout and type the latest row holds."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class LayoutRow(Base):
    """How files of one layout were read last, without what differs from session to session."""

    __tablename__ = "layouts"
    id: Mapped[int] = mapped_column(primary_key=True)
    fingerprint: Mapped[str] = mapped_column(String(64), index=True)
    unit_type: Mapped[str] = mapped_column(String(200))
    mapping: Mapped[dict[str, Any]] = mapped_column(JSON)
    who: Mapped[str]
    remembered_at: Mapped[datetime]
