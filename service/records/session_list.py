"""Which sessions are wanted, and in which order."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.records.decision import Verdict
from service.records.state import RecordState


class SessionOrder(StrEnum):
    """What sessions are listed by; the date of measurement and the identifier order those that are alike."""

    MEASURED = "measured"
    """The newest first."""
    UPLOADED = "uploaded"
    """The last that came first."""
    VERDICT = "verdict"
    """Worst first."""
    UNIT = "unit"


@dataclass(frozen=True)
class SessionQuery:
    """Which sessions are wanted."""

    text: str | None = None
    """Part of the unit's serial number, small and capital letters alike."""
    unit: str | None = None
    """The whole serial number."""
    unit_type: str | None = None
    stand: str | None = None
    since: datetime | None = None
    """Measured then or later."""
    until: datetime | None = None
    """Measured before."""
    state: RecordState | None = None
    verdict: Verdict | None = None
    is_reference: bool | None = None
    """Whether later sessions are judged against it; None where either will do."""
    reserved: bool = False
    """Only those whose verdict is said with a reservation."""
    order: SessionOrder = SessionOrder.MEASURED
    backwards: bool = False
    after: str | None = None
    """The session that the list goes on after; one that is not there begins the list anew."""
    before: str | None = None
    """The session that it ends before."""
    offset: int = 0
    """How many are left out first, where a page has a number instead of a place."""
    limit: int = 100
