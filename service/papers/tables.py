"""The tables of papers: certificates of stands, certificates issued, their signatures and files. All append-only."""

from datetime import datetime

from sqlalchemy import ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class CertificateRow(Base):
    """One issue of a session's certificate: its number, and the hash of its contents. Append-only."""

    __tablename__ = "certificates"
    id: Mapped[int] = mapped_column(primary_key=True)
    number: Mapped[str] = mapped_column(String(60), unique=True)
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), index=True)
    revision: Mapped[int]
    issued_at: Mapped[datetime]
    who: Mapped[str]
    replaces: Mapped[str | None] = mapped_column(String(60))
    content_hash: Mapped[str] = mapped_column(String(64))


class SignatureRow(Base):
    """A signature under an issue and its meaning; bound to the hash of the contents. Append-only."""

    __tablename__ = "certificate_signatures"
    __table_args__ = (UniqueConstraint("certificate_id", "meaning"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    certificate_id: Mapped[int] = mapped_column(ForeignKey("certificates.id"))
    meaning: Mapped[str] = mapped_column(String(20))
    account_id: Mapped[int] = mapped_column(ForeignKey("accounts.id"))
    name: Mapped[str] = mapped_column(String(200))
    signed_at: Mapped[datetime]
    content_hash: Mapped[str] = mapped_column(String(64))


class CertificateFileRow(Base):
    """An approved issue as handed out, byte by byte. Append-only."""

    __tablename__ = "certificate_files"
    __table_args__ = (UniqueConstraint("certificate_id", "format"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    certificate_id: Mapped[int] = mapped_column(ForeignKey("certificates.id"))
    format: Mapped[str] = mapped_column(String(10))
    content: Mapped[bytes]
    sha256: Mapped[str] = mapped_column(String(64))
    sealed_by: Mapped[str]
