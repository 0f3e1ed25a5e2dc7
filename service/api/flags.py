"""Flags of the whole fleet, and what people do about them."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.api.schemas.fields import Limit, Number, Page, Text, next_page
from service.api.schemas.flags import FlagPage, FlagSchema, Handling
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading, StorageOf
from service.flows.handle_flag import acknowledge_flag, resolve_flag
from service.records.flag import FlagState
from service.storage.store import Store
from service.views.flag_list import flag_list

router = APIRouter(prefix="/flags", tags=["flags"])
WantedState = Annotated[FlagState | None, Query(description="Only flags in this state.")]


def flag_page(store: Store, unit: str | None, state: FlagState | None, page: int, limit: int) -> FlagPage:
    """One page of flags as the API answers it."""
    found = [
        FlagSchema.model_validate(flag) for flag in flag_list(store, unit=unit, state=state, page=page, limit=limit)
    ]
    return FlagPage(flags=found, page=page, limit=limit, next_page=next_page(page, limit, len(found)))


@router.get("", responses=errors(404, 422))
def list_flags(
    store: Reading,
    state: WantedState = None,
    unit: Annotated[Text | None, Query(description="Only flags of this serial number.")] = None,
    page: Page = 1,
    limit: Limit = 100,
) -> FlagPage:
    """Flags with their lives, open ones first."""
    return flag_page(store, unit, state, page, limit)


@router.post("/{id}/acknowledge", responses=errors(400, 404, 409, 422))
def acknowledge(id: Number, handling: Handling, storage: StorageOf, now: Now) -> FlagSchema:
    """Say that somebody looks after the flag, and why it can stay for now."""
    return FlagSchema.model_validate(acknowledge_flag(storage, id, handling.by, handling.why, now))


@router.post("/{id}/resolve", responses=errors(400, 404, 409, 422))
def resolve(id: Number, handling: Handling, storage: StorageOf, now: Now) -> FlagSchema:
    """Say that the matter is settled, and how."""
    return FlagSchema.model_validate(resolve_flag(storage, id, handling.by, handling.why, now))
