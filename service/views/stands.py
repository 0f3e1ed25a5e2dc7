"""The stands' own health, as it was last made."""

from service.records.stand import StandCondition
from service.storage.store import Store


def stand_conditions(store: Store) -> tuple[StandCondition, ...]:
    """Every stand with its condition and the evidence, by name."""
    return store.stands.conditions()
