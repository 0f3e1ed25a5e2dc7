"""A record whose fields stand in a row of a table, or in another record, under the same names."""

from collections.abc import Callable
from dataclasses import fields
from enum import StrEnum
from functools import cache
from typing import Any, TypeVar, get_type_hints

T = TypeVar("T")


def copied(kind: type[T], row: object, /, **others: Any) -> T:
    """A record of what a row, or another record, holds under the same names.

    ``others``: the fields that it lacks, or that are something else there. Text that is stored becomes the enumeration
    that the field holds.
    """
    plain: type = kind
    values = {name: made(getattr(row, name)) for name, made in _fields(plain).items() if name not in others}
    return kind(**values, **others)


@cache
def _fields(kind: type) -> dict[str, Callable[[Any], Any]]:
    hints = get_type_hints(kind)
    return {field.name: _enumeration(hints[field.name]) for field in fields(kind)}


def _enumeration(hint: Any) -> Callable[[Any], Any]:
    return hint if isinstance(hint, type) and issubclass(hint, StrEnum) else lambda value: value
