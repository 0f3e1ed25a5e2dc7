"""The forms that keep a view of a list under a name, and remove one."""

from typing import Annotated

from fastapi import APIRouter, Form
from fastapi.responses import RedirectResponse

from service.admission import PersonOf
from service.dependencies import Now, StorageOf
from service.flows.keep_view import remove_view, save_view
from service.pages.forms import NO_NUL, SAYS_SOMETHING, SEE_OTHER, By, Number
from service.pages.saved import query_of, view_of
from service.records.saved_view import ListPage, NewView

router = APIRouter(prefix="/views", include_in_schema=False)
Name = Annotated[str, Form(max_length=100, pattern=SAYS_SOMETHING)]
Query = Annotated[str, Form(max_length=20_000, pattern=NO_NUL)]
"""An address's, percent signs included: nine parts of 200 characters."""


@router.post("")
def save(
    page: Annotated[ListPage, Form()], name: Name, query: Query, by: By, storage: StorageOf, now: Now,
    *, person: PersonOf, shared: Annotated[bool, Form()] = False,
) -> RedirectResponse:  # fmt: skip
    """Keeps what the list is asked for."""
    view = view_of(page, query)
    save_view(storage, NewView(page, name.strip(), query_of(view.url()), shared), person, by, now)
    return RedirectResponse(view.url(), SEE_OTHER)


@router.post("/{id}/remove")
def remove(id: Number, by: By, storage: StorageOf, now: Now, person: PersonOf) -> RedirectResponse:
    """Removes a view; the list stays as it is shown."""
    gone = remove_view(storage, id, person, by, now)
    return RedirectResponse(view_of(gone.page, gone.query).url(), SEE_OTHER)
