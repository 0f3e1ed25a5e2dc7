"""Everything that is known of one unit."""

from dataclasses import dataclass

from service.fleet.condition import UnitSummary
from service.outlook.records import UnitOutlook
from service.sessions.records import StoredSession
from service.sessions.states import StateChange
from service.types.records import UnitType
from service.units.records import NOTHING_SAID, Said, Service


@dataclass(frozen=True)
class UnitReport:
    """Everything a unit's page or answer shows, apart from its history."""

    summary: UnitSummary
    unit_type: UnitType
    reference_session: str | None
    """What the next session will be judged against; None when the next one becomes the reference."""
    sessions: tuple[StoredSession, ...]
    """The latest ones, newest first."""
    services: tuple[Service, ...]
    """All known breaks, oldest first."""
    withdrawn_services: tuple[Service, ...] = ()
    withdrawals: tuple[StateChange, ...] = ()
    """Of these services: by whom, when and why."""
    waiting: int = 0
    """Sessions that are still to be judged again after a change of the records."""
    outlook: UnitOutlook | None = None
    """None before a session was judged."""
    said: Said = NOTHING_SAID
