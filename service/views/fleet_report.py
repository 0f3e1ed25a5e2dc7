"""The whole fleet for a report: what is kept of it, and its units as they are asked for."""

from dataclasses import dataclass
from datetime import datetime

from service.records.fleet import Tally
from service.records.unit import FleetCondition
from service.settings import VERSION
from service.storage.store import Store

MOST_UNITS = 10_000
"""More than a report is read of; it bounds what one answer holds in memory."""


@dataclass(frozen=True)
class FleetReport:
    """The fleet at one moment."""

    at: datetime
    condition: FleetCondition
    tallies: tuple[Tally, ...]
    """Units by verdict and by how much of their tolerance they use."""
    overdue: int
    """Units that should have been calibrated by now."""
    software: str
    """Version."""


def fleet_report(store: Store, now: datetime) -> FleetReport:
    """The condition of the fleet."""
    tallies = store.fleet.tallies()
    return FleetReport(
        at=now,
        condition=FleetCondition.of(tallies),
        tallies=tallies,
        overdue=store.outlooks.overdue(now),
        software=VERSION,
    )
