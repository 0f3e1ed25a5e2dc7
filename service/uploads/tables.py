"""The tables of remembered layouts and of refusals."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, String
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.storage.columns import BYTES
from service.storage.tables import Base


class RefusalRow(Base):
    """An upload that could not be used; its bytes are not stored."""

    __tablename__ = "refusals"
    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    filename: Mapped[str]
    sha256: Mapped[str] = mapped_column(String(64))
    size: Mapped[int] = mapped_column(BYTES)
    problems: Mapped[list[Any]]


class LayoutRow(Base):
    """Latest mapping of files of a layout, without the fields that differ from session to session."""

    __tablename__ = "layouts"
    id: Mapped[int] = mapped_column(primary_key=True)
    fingerprint: Mapped[str] = mapped_column(String(64), index=True)
    unit_type: Mapped[str] = mapped_column(String(200))
    mapping: Mapped[Json] = mapped_column(JSON)
    who: Mapped[str]
    remembered_at: Mapped[datetime]
