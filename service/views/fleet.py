"""Flow: all units at a glance, worst first."""

from service.records.decision import Verdict
from service.records.unit import UnitSummary
from service.storage.queries.fleet import FleetQuery
from service.storage.store import Store


def fleet_overview(
    store: Store, *, verdict: Verdict | None = None, text: str | None = None, page: int = 1, limit: int = 100
) -> tuple[UnitSummary, ...]:
    """One page of the units in a condition, or whose serial number or type holds a text."""
    return store.fleet.units(FleetQuery(verdict, text, (page - 1) * limit, limit))
