"""Lines of the audit trail."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from service.records.answer import answer


@answer
@dataclass(frozen=True)
class AuditLine:
    """Who did what when."""

    id: int
    """Number of the line."""
    at: datetime
    """When, UTC."""
    who: str
    """As they said, or as their account is named."""
    account: str
    """Account that was signed in, with the token that acted for it."""
    action: str
    """What was done."""
    subject: str
    """To what: a session, a unit, a type, a stand, an account."""
    details: dict[str, Any]
    """What before, what after and why, as far as the action has them."""
    hash: str
    """SHA-256 of this line and of the one before it."""


@answer
@dataclass(frozen=True)
class AuditCheck:
    """Whether the trail is as it was written."""

    lines: int
    """How many there are."""
    last: str
    """Hash of the last line; kept elsewhere, it shows later that none was cut off."""
    broken: int | None
    """First line that does not follow from the ones before it; null: none."""
