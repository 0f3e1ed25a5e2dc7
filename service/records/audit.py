"""Lines of the audit trail."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any


@dataclass(frozen=True)
class AuditLine:
    """Who did what when; never changed."""

    id: int
    at: datetime
    who: str
    """As they said, or as their account is named."""
    account: str
    """Account that was signed in, with the token that acted for it; empty where nobody needed to sign in."""
    action: str
    subject: str
    details: dict[str, Any]
    """What before, what after and why, as far as the action has them."""
    hash: str
    """Of this line and of the one before it, 64 hexadecimal digits."""


@dataclass(frozen=True)
class AuditCheck:
    """Whether the trail is as it was written."""

    lines: int
    last: str
    """Hash of the last line: kept elsewhere, it shows later that no line was cut off the end."""
    broken: int | None
    """Number of the first line that does not follow from the ones before it; None of a whole trail."""
