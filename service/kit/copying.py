"""A record whose fields stand in a row of a table, or in another record, under the same names."""

from dataclasses import fields
from enum import StrEnum
from functools import cache
from typing import Any, TypeVar, get_type_hints

T = TypeVar("T")


def copied(kind: type[T], row: object, **others: Any) -> T:
    """A record of what a row, or another record, holds under the same names.

    ``others``: the fields that it lacks, or that are something else there. Text that is stored becomes the enumeration
    that the field holds.
    """
    own = {name: getattr(row, name) for name in _names(kind) if name not in others}
    return kind(**{name: _enumerations(kind).get(name, _same)(value) for name, value in own.items()}, **others)


def _same(value: Any) -> Any:
    return value


@cache
def _names(kind: type) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind))


@cache
def _enumerations(kind: type) -> dict[str, type[StrEnum]]:
    hints = get_type_hints(kind)
    return {name: hint for name, hint in hints.items() if isinstance(hint, type) and issubclass(hint, StrEnum)}
