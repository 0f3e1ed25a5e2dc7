"""Saved views of lists."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from pydantic import computed_field

from service.kit.answer import Hidden, answer


class ListPage(StrEnum):
    """Lists with saved views."""

    FLEET = "fleet"
    SESSIONS = "sessions"
    FLAGS = "flags"

    @property
    def path(self) -> str:
        """Path of the list."""
        return "/" if self is ListPage.FLEET else f"/{self}"


@answer
@dataclass(frozen=True)
class SavedView:
    """A view that is kept."""

    id: int
    """Number of the view."""
    page: ListPage
    """Of which list."""
    name: str
    """Its name."""
    owner: Hidden[str]
    """Login of whose it is; empty where everybody has it."""
    query: str
    """What stands behind the `?` of the list's address."""
    who: str
    """Who kept it last."""
    saved_at: datetime
    """When, UTC."""

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def url(self) -> str:
        """Its address on this service."""
        return f"{self.page.path}?{self.query}" if self.query else self.page.path

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def shared(self) -> bool:
        """Whether everybody has it."""
        return not self.owner


@dataclass(frozen=True)
class NewView:
    """A view to be saved."""

    page: ListPage
    name: str
    query: str
    shared: bool
