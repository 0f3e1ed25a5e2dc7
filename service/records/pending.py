"""A diagnosis that is still to be made."""

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True)
class Pending:
    """What is known of a diagnosis that is still to be made."""

    ticket: str
    """Another one whenever what the diagnosis looks at changes."""
    not_before: datetime | None
    """After a try that failed, until the next one; None where there was none."""


@dataclass(frozen=True)
class Claim:
    """Somebody is at a diagnosis: nobody else begins it before a time."""

    session: str
    who: str
    until: datetime
