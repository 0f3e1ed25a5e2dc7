"""The stands' own health, as it was last made."""

from service.stands.records import StandCondition
from service.stands.store import Stands
from service.storage.queries import Store


def stand_conditions(store: Store) -> tuple[StandCondition, ...]:
    """Every stand with its condition and the evidence, by name."""
    return Stands(store).conditions()
