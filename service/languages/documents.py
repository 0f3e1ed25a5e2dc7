"""Documents in another language: every text of the data that a template is filled with."""

from collections.abc import Callable
from typing import Any

NOT_SAID = frozenset(
    ("key", "shape", "unit", "serial", "unit_type", "notes", "sha256", "who", "number", "address", "code", "sealed_by")
)
"""Fields that name something for the template, or hold what people named or wrote."""
VALUE, BY_SOMEBODY = "value", "is_written"
"""Of a line of a paper: its value, and whether somebody wrote that."""


def document_in(data: Any, say: Callable[[str], str]) -> Any:
    """Plain dicts and lists with their texts said in another language."""
    match data:
        case str():
            return say(data)
        case dict():
            kept = NOT_SAID | {VALUE} if data.get(BY_SOMEBODY) else NOT_SAID
            return {key: value if key in kept else document_in(value, say) for key, value in data.items()}
        case list():
            return [document_in(value, say) for value in data]
        case _:
            return data
