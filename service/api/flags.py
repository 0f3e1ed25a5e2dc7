"""Flags of the whole fleet, and what people do about them."""

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Query

from service.admission import PersonOf
from service.api.schemas.fields import Number, Text, Window, WindowOf
from service.api.schemas.flags import Assigned, Assigning, AssigningSeveral, FlagPage, Handling
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading, StorageOf
from service.flows.assign_flags import Assignment, assign_flag, assign_flags
from service.flows.handle_flag import acknowledge_flag, resolve_flag
from service.records.flag import Flag, FlagState
from service.storage.queries.flags import FlagQuery
from service.storage.store import Store
from service.views.assigned import assignee_meant

router = APIRouter(prefix="/flags", tags=["flags"])
WantedState = Annotated[FlagState | None, Query(description="Only flags in this state.")]

ASSIGNED = "Only flags of this login or name; `me`: of whoever asks; `nobody`: of nobody in particular."


def flag_page(store: Store, wanted: FlagQuery, window: Window) -> FlagPage:
    """One page of flags as the API answers it; NotFoundError for a unit that there is not."""
    if wanted.unit is not None:
        store.units.key(wanted.unit)
    found = store.flags.page(replace(wanted, offset=window.offset, limit=window.limit))
    return FlagPage(flags=found, **window.place(len(found)))


@router.get("", responses=errors(404, 422))
def list_flags(
    store: Reading,
    window: WindowOf,
    state: WantedState = None,
    unit: Annotated[Text | None, Query(description="Only flags of this serial number.")] = None,
    after: Annotated[
        int | None, Query(ge=1, le=2_000_000_000, description="Only those that come after this one.")
    ] = None,
    assigned: Annotated[Text | None, Query(description=ASSIGNED)] = None,
    *,
    person: PersonOf,
) -> FlagPage:
    """Flags with their lives, open ones first."""
    assignee = assignee_meant(store, assigned or "", person)
    return flag_page(store, FlagQuery(unit, state, after=after, assignee=assignee), window)


@router.post("/assign", responses=errors(400, 404, 422))
def assign_several(given: AssigningSeveral, storage: StorageOf, now: Now, person: PersonOf) -> Assigned:
    """Give several flags to somebody, all or none."""
    said = Assignment(given.to, person.signs(given.by), given.why)
    return Assigned(changed=assign_flags(storage, given.flags, said, now))


@router.post("/{id}/assign", responses=errors(400, 404, 409, 422))
def assign(id: Number, given: Assigning, storage: StorageOf, now: Now, person: PersonOf) -> Flag:
    """Say who is to look after the flag."""
    said = Assignment(given.to, person.signs(given.by), given.why)
    return assign_flag(storage, id, said, now)


@router.post("/{id}/acknowledge", responses=errors(400, 404, 409, 422))
def acknowledge(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> Flag:
    """Say that somebody looks after the flag, and why it can stay for now."""
    return acknowledge_flag(storage, id, person.signs(handling.by), handling.why, now)


@router.post("/{id}/resolve", responses=errors(400, 404, 409, 422))
def resolve(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> Flag:
    """Say that the matter is settled, and how."""
    return resolve_flag(storage, id, person.signs(handling.by), handling.why, now)
