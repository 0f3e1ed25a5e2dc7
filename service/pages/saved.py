"""The views of a list that were saved under a name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated
from urllib.parse import parse_qsl, urlsplit

from fastapi import APIRouter, Form
from fastapi.responses import RedirectResponse

from service.flags.view import FlagsView
from service.kit.person import Person
from service.pages.fleet.view import FleetView
from service.pages.session.view import SessionsView
from service.people.admission import PersonOf
from service.people.dependencies import NOT_BLANK, SEE_OTHER, By, Number, StorageOf
from service.people.keep_view import may_remove, may_share, remove_view, save_view
from service.people.views import ListPage, NewView, SavedView
from service.web.dependencies import Now
from service.web.fields import NO_NUL
from service.web.list_view import PLACE, ListView

LISTS: Mapping[ListPage, type[ListView]] = {
    ListPage.FLEET: FleetView,
    ListPage.SESSIONS: SessionsView,
    ListPage.FLAGS: FlagsView,
}
"""How the address of each list is read."""
LONGEST = 200
"""Characters of one part of an address, as `Asked` has it."""


@dataclass(frozen=True)
class SavedLink:
    """One view."""

    id: int
    name: str
    url: str
    is_shown: bool
    """Whether the page shows it."""
    shared: bool
    may_go: bool
    """Whether the one who looks may remove it."""


@dataclass(frozen=True)
class Saved:
    """All views of a list that somebody has."""

    page: ListPage
    links: tuple[SavedLink, ...]
    query: str
    """Of the view that is shown; empty where nothing is asked, which needs no name."""
    is_signed_in: bool
    """Whether somebody can keep one for themselves."""
    may_share: bool

    @property
    def may_save(self) -> bool:
        """Whether the view that is shown can be kept, and is not yet."""
        is_known = any(link.is_shown for link in self.links)
        return bool(self.query) and not is_known and (self.is_signed_in or self.may_share)

    @property
    def shown(self) -> SavedLink | None:
        """The view that the page shows, if it may be removed."""
        return next((link for link in self.links if link.is_shown and link.may_go), None)


def saved(found: Sequence[SavedView], view: ListView, page: ListPage, person: Person) -> Saved:
    """The links above a list."""
    first = view.first()
    return Saved(page, tuple(_link(s, first, person) for s in found), query_of(first), bool(person.login),
                 may_share(person))  # fmt: skip


def _link(view: SavedView, first: str, person: Person) -> SavedLink:
    url = address(view)
    return SavedLink(view.id, view.name, url, url == first, view.shared, may_remove(view, person))


def address(view: SavedView) -> str:
    """Where a view is shown: what this version does not know of it is left out."""
    return view_of(view.page, view.query).url()


def view_of(page: ListPage, query: str) -> ListView:
    """The view that a query asks for, from its first page on; what of it cannot be asked is left out."""
    given = {k: v[:LONGEST].replace("\x00", "") for k, v in parse_qsl(query) if k not in PLACE}
    return LISTS[page].model_validate(given)


def query_of(url: str) -> str:
    """What is asked of an address."""
    return urlsplit(url).query


router = APIRouter(prefix="/views", include_in_schema=False)
Name = Annotated[str, Form(max_length=100, pattern=NOT_BLANK)]
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
