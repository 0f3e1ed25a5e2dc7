"""The table of what histories tell of their type; rebuilt with a unit's outlook."""

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class HistoryRow(Base):
    """What a unit's histories of one parameter tell of its type, without their sessions."""

    __tablename__ = "histories"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True)
    kind: Mapped[str] = mapped_column(String(20), primary_key=True)
    parameter: Mapped[str] = mapped_column(String(20), primary_key=True)
    evidence: Mapped[bytes]
