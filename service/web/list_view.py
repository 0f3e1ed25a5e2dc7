"""Filters and order of a list, kept in the address so that it can be saved, shared and revisited."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar
from urllib.parse import urlencode

from pydantic import Field

from estimator.message import say
from service.web.fields import NO_NUL

QueryText = Annotated[str, Field(max_length=200, pattern=NO_NUL)]
"""Text of a query parameter."""


def address_of(path: str, parameters: Mapping[str, object]) -> str:
    """A path with its query; empty parameters are left out."""
    filled = {name: value for name, value in parameters.items() if value}
    return f"{path}?{urlencode(filled)}" if filled else path


@dataclass(frozen=True)
class ListView:
    """A list filtered and ordered by its address. Empty fields are unset."""

    PATH: ClassVar[str]
    NAMES: ClassVar[Mapping[str, str]]
    """Query parameters of the fields, in order."""
    PLAIN: ClassVar[Mapping[str, object]]
    """Defaults, which an address leaves out."""
    FIRST: ClassVar[Mapping[str, str | int]]
    """Parameters of the first page."""
    ORDERS: ClassVar[Mapping[str, str]]
    """Orders of the list, in words."""
    sort: str = ""
    """One of the orders, with ``-`` before it where reversed."""

    @property
    def order(self) -> str:
        """The order of the list."""
        return self.sort.removeprefix("-")

    @property
    def backwards(self) -> bool:
        """Whether the order is reversed."""
        return self.sort.startswith("-")

    @property
    def order_in_words(self) -> str:
        """``by condition, least margin to tolerance first``."""
        return say("{order}, backwards", order=self.ORDERS[self.order]) if self.backwards else self.ORDERS[self.order]

    @property
    def narrows(self) -> bool:
        """Whether any filter is set."""
        return any(value for field, value in vars(self).items() if field not in ("sort", *self.FIRST))

    def url(self, **changes: str | int) -> str:
        """The address of this view with some fields changed."""
        fields = {**vars(self), **changes}
        parameters = {name: fields[f] for f, name in self.NAMES.items() if fields[f] != self.PLAIN.get(f, "")}
        return address_of(self.PATH, parameters)

    def sorted_by(self, order: str) -> str:
        """The address of the list in another order, or reversed where it has this one; from its first page."""
        return self.url(**{**self.FIRST, "sort": f"-{order}" if self.sort == order else order})


def known_order(requested: str, orders: Mapping[str, str], default: str) -> str:
    """The requested order, or a default for an unknown one."""
    return requested if requested.removeprefix("-") in orders else default
