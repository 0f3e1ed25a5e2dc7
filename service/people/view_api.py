"""Saved views of lists, over HTTP."""

from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import BaseModel, Field, StringConstraints

from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.people.keep_view import remove_view, save_view
from service.people.view_store import SavedViews
from service.people.views import ListPage, NewView, SavedView
from service.web.dependencies import Now, Reading
from service.web.fields import Body, Name, Number
from service.web.problem_document import errors

ViewName = Annotated[str, StringConstraints(pattern=r"^[^\x00]*\S[^\x00]*$", max_length=100)]
ViewQuery = Annotated[str, StringConstraints(pattern=r"^[^\x00?#\s]*$", max_length=20_000)]


class NewViewSchema(
    Body,
    json_schema_extra={
        "example": {"page": "fleet", "name": "overdue on ODG-1", "query": "due=overdue&stand=ODG-1", "by": "K. Ito"}
    },
):
    """A view to keep."""

    page: ListPage = Field(description="Of which list.")
    name: ViewName = Field(description="Its name.")
    query: ViewQuery = Field(description="What stands behind the `?` of the list's address.")
    shared: bool = Field(default=False, description="For everybody; where nobody signs in, every view is.")
    by: Name = Field(description="Who keeps it.")


class ViewList(BaseModel):
    """Views of lists."""

    views: tuple[SavedView, ...] = Field(description="The views, by list and name.")


router = APIRouter(prefix="/views", tags=["views"])


@router.get("", responses=errors(422))
def list_views(
    store: Reading, person: PersonOf, page: Annotated[ListPage | None, Query(description="Only of this list.")] = None
) -> ViewList:
    """Views that everybody has, and your own."""
    return ViewList(views=SavedViews(store).of(person.login, page))


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
