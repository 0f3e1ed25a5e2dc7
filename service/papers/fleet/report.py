"""The whole fleet for a report: its stored counts, and its units as they are requested."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

from service.fleet.condition import FleetCondition
from service.fleet.records import Tally
from service.fleet.store import Fleet
from service.fleet.use import Use
from service.fleet.uses_store import Uses
from service.outlook.store import Outlooks
from service.settings import VERSION
from service.storage.queries import Store

MOST_UNITS = 10_000
"""More than a report is read of; it bounds what one answer holds in memory."""


@dataclass(frozen=True)
class FleetReport:
    """The fleet at one moment."""

    at: datetime
    condition: FleetCondition
    tallies: tuple[Tally, ...]
    """Units by verdict and by how much of their tolerance they use."""
    uses: Mapping[Use, int]
    """Number of units with each answer."""
    overdue: int
    """Units that should have been calibrated by now."""
    software: str


def fleet_report(store: Store, now: datetime) -> FleetReport:
    """The condition of the fleet."""
    tallies = Fleet(store).tallies()
    return FleetReport(
        at=now,
        condition=FleetCondition.of(tallies),
        tallies=tallies,
        uses=Uses(store).at(now),
        overdue=Outlooks(store).overdue(now),
        software=VERSION,
    )
