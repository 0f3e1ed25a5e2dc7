"""What somebody puts under a certificate: their name, when, and what it means."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.records.answer import answer


class Meaning(StrEnum):
    """What a signature says; in the order in which they are given."""

    REVIEWED = "reviewed"
    APPROVED = "approved"


@answer
@dataclass(frozen=True)
class Signature:
    """One signature under a certificate."""

    certificate: str
    """Number of the certificate."""
    meaning: Meaning
    """What it says."""
    login: str
    """Account that signed, with its password."""
    name: str
    """As it is printed."""
    signed_at: datetime
    """UTC."""
    content_hash: str
    """SHA-256 of all that the certificate stated when it was signed."""


@dataclass(frozen=True)
class CertificateFile:
    """An approved issue as it is handed out, byte by byte."""

    format: str
    """``pdf`` or ``dcc``."""
    content: bytes
    sha256: str
    sealed_by: str
    """Subject of the certificate of the laboratory's key; empty where it has none."""
