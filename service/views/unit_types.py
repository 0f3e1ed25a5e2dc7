"""Flow: unit types with the tolerances that hold now."""

from service.records.unit import UnitType
from service.storage.store import Store


def unit_types(store: Store, *, page: int = 1, limit: int = 100) -> tuple[UnitType, ...]:
    """One page of the types, by name."""
    return store.unit_types.page((page - 1) * limit, limit)


def unit_type(store: Store, name: str) -> UnitType:
    """One type."""
    return store.unit_types.get(name)
