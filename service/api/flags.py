"""Flags of the whole fleet, and what people do about them."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.admission import PersonOf
from service.api.schemas.fields import Number, Text, Window, WindowOf
from service.api.schemas.flags import FlagPage, FlagSchema, Handling
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading, StorageOf
from service.flows.handle_flag import acknowledge_flag, resolve_flag
from service.records.flag import FlagState
from service.storage.queries.flags import FlagQuery
from service.storage.store import Store

router = APIRouter(prefix="/flags", tags=["flags"])
WantedState = Annotated[FlagState | None, Query(description="Only flags in this state.")]


def flag_page(store: Store, unit: str | None, state: FlagState | None, window: Window) -> FlagPage:
    """One page of flags as the API answers it; NotFoundError for a unit that there is not."""
    if unit is not None:
        store.units.key(unit)
    wanted = FlagQuery(unit, state, window.offset, window.limit)
    found = [FlagSchema.model_validate(flag) for flag in store.flags.page(wanted)]
    return FlagPage(flags=found, page=window.page, limit=window.limit, next_page=window.next_after(len(found)))


@router.get("", responses=errors(404, 422))
def list_flags(
    store: Reading,
    window: WindowOf,
    state: WantedState = None,
    unit: Annotated[Text | None, Query(description="Only flags of this serial number.")] = None,
) -> FlagPage:
    """Flags with their lives, open ones first."""
    return flag_page(store, unit, state, window)


@router.post("/{id}/acknowledge", responses=errors(400, 404, 409, 422))
def acknowledge(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> FlagSchema:
    """Say that somebody looks after the flag, and why it can stay for now."""
    return FlagSchema.model_validate(acknowledge_flag(storage, id, person.signs(handling.by), handling.why, now))


@router.post("/{id}/resolve", responses=errors(400, 404, 409, 422))
def resolve(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> FlagSchema:
    """Say that the matter is settled, and how."""
    return FlagSchema.model_validate(resolve_flag(storage, id, person.signs(handling.by), handling.why, now))
