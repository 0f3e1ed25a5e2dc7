"""Views of lists that people keep."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum


class ListPage(StrEnum):
    """Lists of which views are kept."""

    FLEET = "fleet"
    SESSIONS = "sessions"
    FLAGS = "flags"

    @property
    def path(self) -> str:
        """Of the list's address."""
        return "/" if self is ListPage.FLEET else f"/{self}"


@dataclass(frozen=True)
class SavedView:
    """What a list is asked for, under a name."""

    id: int
    page: ListPage
    name: str
    owner: str
    """Login of whose it is; empty where everybody has it."""
    query: str
    """What stands behind the `?` of the list's address: filter and order."""
    who: str
    """Who saved it last."""
    saved_at: datetime

    @property
    def url(self) -> str:
        """Its address."""
        return f"{self.page.path}?{self.query}" if self.query else self.page.path

    @property
    def shared(self) -> bool:
        """Whether everybody has it."""
        return not self.owner


@dataclass(frozen=True)
class NewView:
    """A view to be kept."""

    page: ListPage
    name: str
    query: str
    shared: bool
