"""Flow: how many units are in which condition."""

from service.records.unit import FleetCondition
from service.storage.store import Store


def fleet_condition(store: Store) -> FleetCondition:
    """Counts over the whole fleet."""
    return store.fleet.condition()
