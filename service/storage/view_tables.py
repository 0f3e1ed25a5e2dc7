"""The table of views of lists that people keep."""

from datetime import datetime

from sqlalchemy import String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class SavedViewRow(Base):
    """What one list is asked for, under a name; of somebody's own views and of the shared ones each name is there
    once."""

    __tablename__ = "saved_views"
    __table_args__ = (UniqueConstraint("page", "owner", "name"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    page: Mapped[str] = mapped_column(String(20))
    name: Mapped[str] = mapped_column(String(100))
    owner: Mapped[str] = mapped_column(String(60))
    """Login of whose it is; empty where everybody has it."""
    query: Mapped[str]
    who: Mapped[str]
    saved_at: Mapped[datetime]
