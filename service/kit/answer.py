"""Records that the API returns as they are; the string under a field is its description in OpenAPI."""

import ast
from dataclasses import is_dataclass
from functools import cache
from inspect import getsource
from itertools import pairwise
from typing import Annotated, TypeVar

from pydantic import Field

from estimator.json_object import Json

T = TypeVar("T")
Hidden = Annotated[T, Field(exclude=True)]
"""Type of a field that no answer holds."""


def answer(record: type[T]) -> type[T]:
    """Has OpenAPI describe a record by its docstrings."""
    record.__pydantic_config__ = {"json_schema_extra": _describe}  # type: ignore[attr-defined]  # where pydantic looks
    return record


def _describe(schema: Json, record: type) -> None:
    """An answer holds every field, those with a default too."""
    fields: dict[str, Json] = schema.get("properties", {})
    texts = {name: text for base in reversed(record.__mro__) for name, text in _texts(base).items()}
    for name, field in fields.items():
        for name_of_input in ("default", "readOnly"):
            field.pop(name_of_input, None)
        if name in texts:
            field["description"] = texts[name]
    schema["required"] = list(fields)


@cache
def _texts(record: type) -> dict[str, str]:
    """The docstrings under the fields that a class itself declares, each on one line."""
    if not is_dataclass(record):
        return {}
    (declared,) = ast.parse(getsource(record)).body
    assert isinstance(declared, ast.ClassDef)
    return {
        field.target.id: " ".join(under.value.value.split())
        for field, under in pairwise(declared.body)
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
        and isinstance(under, ast.Expr) and isinstance(under.value, ast.Constant) and isinstance(under.value.value, str)
    }  # fmt: skip
