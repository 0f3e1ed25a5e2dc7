"""JSON of the service as the types of `answers`: unknown fields are ignored; a missing field, or one of another type,
is an error that names it."""

from dataclasses import fields, is_dataclass
from datetime import datetime
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from estimator.json_object import Json
from service.errors import ServiceError

T = TypeVar("T")
WHOLE = "document"
"""The field with the whole answer."""


def read(kind: type[T], document: Any) -> T:
    """An answer, or one object within it, as a type; ServiceError where the service is of another version."""
    try:
        return _object(kind, document)
    except (KeyError, TypeError, ValueError) as fault:
        raise ServiceError(f"The service's answer cannot be read as {kind.__name__}: {fault!r}.") from fault


@cache
def _hints(kind: type[Any]) -> dict[str, Any]:
    return get_type_hints(kind)


def _object(kind: type[T], document: Json) -> T:
    hints, names = _hints(kind), [field.name for field in fields(kind)]  # type: ignore[arg-type]  # all are dataclasses
    known = {name: _value(hints[name], document[name], name) for name in names if name != WHOLE}
    return kind(**known, **({WHOLE: document} if WHOLE in names else {}))


def _value(hint: Any, value: Any, name: str) -> Any:
    origin = get_origin(hint)
    if origin in (Union, UnionType):
        return None if value is None else _value(next(a for a in get_args(hint) if a is not NoneType), value, name)
    if origin is tuple:
        return tuple(_value(get_args(hint)[0], item, name) for item in value)
    if origin is Literal:
        return _checked(value, value in get_args(hint), name)
    if is_dataclass(hint):
        return _object(hint, value)  # type: ignore[arg-type]  # a class, not an object of one
    if hint is datetime:
        return datetime.fromisoformat(value)
    if hint is float:
        return float(_checked(value, isinstance(value, int | float), name))
    return _checked(value, isinstance(value, hint), name)


def _checked(value: Any, is_valid: bool, name: str) -> Any:
    if not is_valid:
        raise TypeError(f"{name} is {value!r}")
    return value
