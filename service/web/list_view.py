"""What a visitor asked a list for: it stands in the address, so that it can be kept, sent on and gone back to."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar
from urllib.parse import urlencode

from pydantic import Field

from estimator.message import say
from service.web.fields import NO_NUL

Asked = Annotated[str, Field(max_length=200, pattern=NO_NUL)]
"""A part of an address, as it came."""


def address_of(path: str, asked: Mapping[str, object]) -> str:
    """A path with what is asked of it; empty parts are left out."""
    kept = {name: value for name, value in asked.items() if value}
    return f"{path}?{urlencode(kept)}" if kept else path


@dataclass(frozen=True)
class ListView:
    """A list that is narrowed and ordered by its address. Every field is empty where nothing is asked."""

    PATH: ClassVar[str]
    NAMES: ClassVar[Mapping[str, str]]
    """Fields as they are called in an address, in its order."""
    PLAIN: ClassVar[Mapping[str, object]]
    """What an address need not say: the list as it is unasked."""
    FIRST: ClassVar[Mapping[str, str | int]]
    """What leads to the first page."""
    ORDERS: ClassVar[Mapping[str, str]]
    """What the list can be ordered by, in words."""
    sort: str = ""
    """One of these, with ``-`` before it where backwards."""

    @property
    def order(self) -> str:
        """What the list is ordered by."""
        return self.sort.removeprefix("-")

    @property
    def backwards(self) -> bool:
        """Whether the last comes first."""
        return self.sort.startswith("-")

    @property
    def order_in_words(self) -> str:
        """``by condition, least margin to tolerance first``."""
        return say("{order}, backwards", order=self.ORDERS[self.order]) if self.backwards else self.ORDERS[self.order]

    @property
    def narrows(self) -> bool:
        """Whether it leaves anything out."""
        return any(value for field, value in vars(self).items() if field not in ("sort", *self.FIRST))

    def url(self, **changes: str | int) -> str:
        """The address of this view with something changed."""
        asked = {**vars(self), **changes}
        shown = {name: asked[f] for f, name in self.NAMES.items() if asked[f] != self.PLAIN.get(f, "")}
        return address_of(self.PATH, shown)

    def sorted_by(self, order: str) -> str:
        """The address of the list in another order, or backwards where it has this one; from its first page on."""
        return self.url(**{**self.FIRST, "sort": f"-{order}" if self.sort == order else order})


def known_order(asked: str, orders: Mapping[str, str], otherwise: str) -> str:
    """The order that an address asks for, or another where nobody knows it."""
    return asked if asked.removeprefix("-") in orders else otherwise
