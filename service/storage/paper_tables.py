"""The tables of what papers name: certificates of stands, and numbers of certificates. Both are append-only."""

from datetime import date, datetime

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class StandCertificateRow(Base):
    """A certificate of a stand as it was recorded; of one number the latest row holds. Append-only."""

    __tablename__ = "stand_certificates"
    id: Mapped[int] = mapped_column(primary_key=True)
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), index=True)
    number: Mapped[str] = mapped_column(String(200))
    issued_by: Mapped[str] = mapped_column(String(200))
    issued_on: Mapped[date]
    valid_until: Mapped[date]
    who: Mapped[str]
    recorded_at: Mapped[datetime]


class CertificateRow(Base):
    """One issue of a session's certificate: its number, and the hash of all that it states. Append-only."""

    __tablename__ = "certificates"
    id: Mapped[int] = mapped_column(primary_key=True)
    number: Mapped[str] = mapped_column(String(60), unique=True)
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), index=True)
    revision: Mapped[int]
    issued_at: Mapped[datetime]
    who: Mapped[str]
    replaces: Mapped[str | None] = mapped_column(String(60))
    content_hash: Mapped[str] = mapped_column(String(64))
