"""The whole fleet for a report, worst units first."""

from dataclasses import dataclass
from datetime import datetime

from service.records.fleet import FleetQuery
from service.records.outlook import UnitOutlook
from service.records.unit import FleetCondition, UnitSummary
from service.settings import VERSION
from service.storage.store import Store
from service.views.outlook import outlooks_of_fleet

MOST_UNITS = 10_000
"""More than a report is read of; it bounds what one answer holds in memory."""


@dataclass(frozen=True)
class FleetReport:
    """The fleet at one moment."""

    at: datetime
    condition: FleetCondition
    units: tuple[UnitSummary, ...]
    """Worst first."""
    outlooks: tuple[UnitOutlook, ...]
    """When each must be calibrated next, and why."""
    software: str
    """Version."""


def fleet_report(store: Store, now: datetime) -> FleetReport:
    """The condition of every unit."""
    return FleetReport(
        at=now,
        condition=store.fleet.condition(),
        units=store.fleet.units(FleetQuery(limit=MOST_UNITS)),
        outlooks=outlooks_of_fleet(store, now),
        software=VERSION,
    )
