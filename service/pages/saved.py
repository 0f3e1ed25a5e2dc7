"""The views of a list that were kept under a name: links above it, and the form that keeps the one that is shown."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from pydantic import BaseModel

from service.flows.keep_view import may_remove, may_share
from service.pages.flags_view import FlagsAsked, FlagsView
from service.pages.fleet_view import FleetAsked, FleetView
from service.pages.list_view import ListView
from service.pages.sessions_view import SessionsAsked, SessionsView
from service.records.identity import Person
from service.records.saved_view import ListPage, SavedView

LISTS: Mapping[ListPage, tuple[type[BaseModel], Any]] = {
    ListPage.FLEET: (FleetAsked, FleetView),
    ListPage.SESSIONS: (SessionsAsked, SessionsView),
    ListPage.FLAGS: (FlagsAsked, FlagsView),
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
    own: bool
    """Whether somebody can keep one for themselves."""
    may_share: bool

    @property
    def may_save(self) -> bool:
        """Whether the view that is shown can be kept, and is not yet."""
        is_known = any(link.is_shown for link in self.links)
        return bool(self.query) and not is_known and (self.own or self.may_share)

    @property
    def shown(self) -> SavedLink | None:
        """The view that the page shows, if it may be removed."""
        return next((link for link in self.links if link.is_shown and link.may_go), None)


def saved(found: Sequence[SavedView], view: ListView, page: ListPage, person: Person) -> Saved:
    """The links above a list."""
    first = view.url(**view.FIRST)
    return Saved(page, tuple(_link(one, first, person) for one in found), query_of(first), bool(person.login),
                 may_share(person))  # fmt: skip


def _link(one: SavedView, first: str, person: Person) -> SavedLink:
    url = address(one)
    return SavedLink(one.id, one.name, url, url == first, one.shared, may_remove(one, person))


def address(view: SavedView) -> str:
    """Where a view is shown: what this version does not know of it is left out."""
    return view_of(view.page, view.query).url()


def view_of(page: ListPage, query: str) -> ListView:
    """The view that a query asks for, from its first page on; what of it cannot be asked is left out."""
    asked, view = LISTS[page]
    places = {view.NAMES[field] for field in view.FIRST}
    given = {k: v[:LONGEST].replace("\x00", "") for k, v in parse_qsl(query) if k not in places}
    found: ListView = view.of(asked(**given))
    return found


def query_of(url: str) -> str:
    """What is asked of an address."""
    return urlsplit(url).query
