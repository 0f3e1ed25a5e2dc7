"""Views of lists that people keep under a name."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.admission import PersonOf
from service.api.schemas.fields import Name, Number
from service.api.schemas.problem import errors
from service.api.schemas.views import NewViewSchema, ViewList
from service.dependencies import Now, Reading, StorageOf
from service.flows.keep_view import remove_view, save_view
from service.records.saved_view import ListPage, NewView, SavedView

router = APIRouter(prefix="/views", tags=["views"])


@router.get("", responses=errors(422))
def list_views(
    store: Reading,
    person: PersonOf,
    page: Annotated[ListPage | None, Query(description="Only of this list.")] = None,
) -> ViewList:
    """Views that everybody has, and your own."""
    return ViewList(views=store.saved_views.of(person.login, page))


@router.post("", status_code=201, responses=errors(400, 409, 422))
def keep_view(new: NewViewSchema, storage: StorageOf, now: Now, person: PersonOf) -> SavedView:
    """Keep a view; under a name that is there already it replaces the other."""
    wanted = NewView(new.page, new.name.strip(), new.query, new.shared)
    return save_view(storage, wanted, person, person.signs(new.by), now)


@router.delete("/{id}", status_code=204, responses=errors(404, 422))
def delete_view(
    id: Number,
    storage: StorageOf,
    now: Now,
    person: PersonOf,
    by: Annotated[Name, Query(description="Who removes it.")],
) -> None:
    """Remove a view."""
    remove_view(storage, id, person, person.signs(by), now)
