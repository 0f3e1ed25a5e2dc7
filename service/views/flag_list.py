"""Flow: flags with their lives, of one unit or of the fleet."""

from service.records.flag import Flag, FlagState
from service.storage.queries.flags import FlagQuery
from service.storage.store import Store


def flag_list(
    store: Store, *, unit: str | None = None, state: FlagState | None = None, page: int = 1, limit: int = 100
) -> tuple[Flag, ...]:
    """One page of flags, open ones first, newest first; NotFoundError for a unit that there is not."""
    if unit is not None:
        store.units.key(unit)
    return store.flags.page(FlagQuery(unit, state, (page - 1) * limit, limit))


def open_flags(store: Store, most: int) -> tuple[Flag, ...]:
    """The newest flags of the fleet that are not resolved."""
    return tuple(flag for flag in store.flags.page(FlagQuery(limit=most)) if flag.state is not FlagState.RESOLVED)
