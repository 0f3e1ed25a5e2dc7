"""Lists: their filters, their orders, and the entry from which they are read.

A page of a list begins after an entry, not after a number of them: it costs the same however far one reads, and changes
meanwhile move nothing (keyset paging).
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Generic, TypeVar, TypeVarTuple

from sqlalchemy import ColumnElement, Select, and_, false, literal, or_, tuple_
from sqlalchemy.orm import Session

from service.kit.listing import ListQuery

Columns = TypeVarTuple("Columns")
Wanted = TypeVar("Wanted", bound=ListQuery)
Entry = TypeVar("Entry")


@dataclass(frozen=True)
class Key:
    """One of the columns that a list is ordered by."""

    column: Any
    is_falling: bool = False
    """Whether the largest comes first."""
    nulls_first: bool | None = None
    """Whether entries without it come first; None where every entry has it."""
    stays: bool = False
    """Whether it orders entries that are otherwise alike, and does so backwards too."""
    known: Callable[[Any], Any] | None = None
    """Value of an entry by the entry's name; None where the entry is looked up."""

    @property
    def turned(self) -> "Key":
        """The key read backwards."""
        nulls_first = None if self.nulls_first is None else not self.nulls_first
        return replace(self, is_falling=not self.is_falling, nulls_first=nulls_first)

    @property
    def order(self) -> ColumnElement[Any]:
        """The key as a term of a query's order."""
        order: ColumnElement[Any] = self.column.desc() if self.is_falling else self.column.asc()
        if self.nulls_first is None:
            return order
        return order.nulls_first() if self.nulls_first else order.nulls_last()

    def is_after(self, value: Any) -> ColumnElement[bool]:
        """Entries that come later by this column alone."""
        if value is None:
            return self.column.is_not(None) if self.nulls_first else false()
        later: ColumnElement[bool] = self.column < value if self.is_falling else self.column > value
        return or_(later, self.column.is_(None)) if self.nulls_first is False else later

    def is_same(self, value: Any) -> ColumnElement[bool]:
        """Entries that are alike by it."""
        same: ColumnElement[bool] = self.column.is_(None) if value is None else self.column == value
        return same


@dataclass(frozen=True)
class PageQuery:
    """The part of a list that a query asks for."""

    query: ListQuery
    keys: tuple[Key, ...]
    """Keys in the direction of reading: entries before another are read backwards from it."""
    conditions: tuple[ColumnElement[bool], ...]

    def cut(self, rows: Select[*Columns]) -> Select[*Columns]:
        """The rows of the page, in its order."""
        narrowed = self.ordered(rows.where(*self.conditions))
        return narrowed.offset(self.query.offset).limit(self.query.limit)

    def ordered(self, rows: Select[*Columns]) -> Select[*Columns]:
        """Rows in its order."""
        return rows.order_by(*(key.order for key in self.keys))

    def forward(self, found: Iterable[Entry]) -> tuple[Entry, ...]:
        """Entries in the order of the list, whichever way they were read."""
        return tuple(found) if self.query.before is None else tuple(found)[::-1]


@dataclass(frozen=True)
class Listing(Generic[Wanted]):
    """Rules for reading a list from the store."""

    name: Any
    """The column that an entry is named by where a list goes on from it."""
    keys: Callable[[Wanted], tuple[Key, ...]]
    """Columns of each order; no two entries have the same values."""
    conditions: Mapping[str, Callable[[Any], ColumnElement[bool]]]
    """Conditions by field of a query, where it has another value than the field's default."""

    def page(self, session: Session, rows: Select[*tuple[Any, ...]], wanted: Wanted) -> PageQuery:
        """The page for a query; one more query where the list goes on from an entry that must be looked up."""
        named = wanted.after if wanted.before is None else wanted.before
        keys = self.keys(wanted)
        place = None if named is None else self._place(session, rows, keys, named)
        if place is None:
            wanted = replace(wanted, after=None, before=None)
        read = tuple(_directed(keys, wanted))
        narrowing = tuple(self._narrowing(wanted))
        return PageQuery(wanted, read, narrowing if place is None else (*narrowing, _beyond(read, place)))

    def _narrowing(self, wanted: Wanted) -> Iterator[ColumnElement[bool]]:
        for field in fields(wanted):
            value = getattr(wanted, field.name)
            if field.name in self.conditions and value != field.default:
                yield self.conditions[field.name](value)

    def _place(
        self, session: Session, rows: Select[*tuple[Any, ...]], keys: tuple[Key, ...], named: Any
    ) -> Sequence[Any] | None:
        """The keys of an entry; None where it is not there."""
        if all(key.known for key in keys):
            return [key.known(named) for key in keys if key.known]
        columns = (key.column for key in keys)
        found = rows.with_only_columns(*columns, maintain_column_froms=True).where(self.name == named)
        return session.execute(found).one_or_none()


def _directed(keys: Iterable[Key], wanted: ListQuery) -> Iterator[Key]:
    for key in keys:
        turns = (wanted.backwards and not key.stays) != (wanted.before is not None)
        yield key.turned if turns else key


def _beyond(keys: Sequence[Key], place: Sequence[Any]) -> ColumnElement[bool]:
    """Entries that come after the one with these values. As one comparison of rows where all keys run one way, which
    an index answers."""
    if len({key.is_falling for key in keys}) == 1 and not any(key.known or key.nulls_first is not None for key in keys):
        row = tuple_(*(key.column for key in keys))
        position = tuple_(*(literal(value, key.column.type) for key, value in zip(keys, place, strict=True)))
        return row < position if keys[0].is_falling else row > position
    found: list[ColumnElement[bool]] = []
    alike: list[ColumnElement[bool]] = []
    for key, value in zip(keys, place, strict=True):
        found.append(and_(*alike, key.is_after(value)))
        alike.append(key.is_same(value))
    return or_(*found)
