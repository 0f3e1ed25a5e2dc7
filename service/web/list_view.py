"""Filter and order of a list. They are part of its address, so that it can be kept, sent on and gone back to."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, Generic, TypeVar
from urllib.parse import urlencode

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from estimator.message import say
from service.web.fields import Sought

Words = Annotated[Sought, AfterValidator(str.strip)]
"""Part of a name."""
Entry = TypeVar("Entry")
LAST = ("sort", "page", "after", "before")
"""Parameters at the end of an address."""
PLACE = LAST[1:]
"""Parameters of the page of the list."""


def one_of(known: Collection[str]) -> AfterValidator:
    """Leaves out unknown values."""
    return AfterValidator(lambda asked: asked if asked in known else "")


def address_of(path: str, asked: Mapping[str, object]) -> str:
    """The address of a path with its query; empty parts are left out."""
    kept = {name: value for name, value in asked.items() if value}
    return f"{path}?{urlencode(kept)}" if kept else path


class ListView(BaseModel):
    """A list that is filtered and ordered by its address: every field is a part of it, in the order of the address. A
    field is empty where the address has no value for it, or an unknown one.
    """

    model_config = ConfigDict(frozen=True)
    PATH: ClassVar[str]
    ORDERS: ClassVar[Mapping[str, str]]
    """Possible orders of the list, with their names in words; the first is the default."""
    PAGE_SIZE: ClassVar[int] = 20
    """Entries on a page: three screens at most."""

    sort: Annotated[Sought, Field(validate_default=True)] = ""
    """One of the orders, with ``-`` before it where backwards."""
    after: Sought = ""
    """The entry that this page follows."""
    before: Sought = ""
    """The entry that it comes before."""

    @field_validator("sort")
    @classmethod
    def known_order(cls, asked: str) -> str:
        """The requested order, or the first where that is unknown."""
        return asked if asked.removeprefix("-") in cls.ORDERS else next(iter(cls.ORDERS))

    @field_validator("before")
    @classmethod
    def one_place(cls, asked: str, info: ValidationInfo) -> str:
        """A page that follows an entry comes before none."""
        return "" if info.data.get("after") else asked

    @property
    def order(self) -> str:
        """Column by which the list is ordered."""
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
        return any(value for name, value in self if name not in LAST)

    def url(self, **changes: str | int) -> str:
        """The address of this view with something changed; what the list is as it is unasked need not be said."""
        asked, plain = self.model_dump() | changes, type(self)().model_dump()
        names = sorted(asked, key=lambda name: LAST.index(name) if name in LAST else -1)
        return address_of(self.PATH, {name: asked[name] for name in names if asked[name] != plain[name]})

    def first(self, **changes: str | int) -> str:
        """The address of its first page."""
        plain = type(self)().model_dump(include={*PLACE})
        return self.url(**plain | changes)

    def sorted_by(self, order: str) -> str:
        """The address of the list in another order, or backwards where it has this one; from its first page on."""
        return self.first(sort=f"-{order}" if self.sort == order else order)

    def earlier(self, entry: str, *, others: bool) -> str:
        """The address of the page before an entry; empty where there is none."""
        is_first = not others if self.before else not self.after
        return "" if is_first or not entry else self.url(before=entry, after="")

    def later(self, entry: str, *, others: bool) -> str:
        """The address of the page after an entry; empty where there is none."""
        return self.url(after=entry, before="") if entry and (others or self.before) else ""


@dataclass(frozen=True)
class Shown(Generic[Entry]):
    """One page of a list."""

    entries: tuple[Entry, ...]
    earlier: str
    """Address of the page before this one; empty where it is the first."""
    later: str
    """Address of the next page; empty where it is the last."""

    @classmethod
    def of(cls, view: ListView, found: Sequence[Entry], name: Callable[[Entry], object]) -> "Shown[Entry]":
        """One entry more than fit on a page says that there are others in the direction of reading."""
        size, others = view.PAGE_SIZE, len(found) > view.PAGE_SIZE
        entries = tuple(found[-size:] if view.before else found[:size])
        first, last = (str(name(entry)) for entry in (entries[0], entries[-1])) if entries else ("", "")
        return cls(entries, view.earlier(first, others=others), view.later(last, others=others))
