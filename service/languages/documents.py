"""Translation of documents: every text of the data of a template."""

import re
from collections.abc import Callable
from typing import Any

SAY_CALL = re.compile(r"\bsay\(\"([^\"]+)\"")
"""A text in a typesetter's template."""
UNTRANSLATED = frozenset(
    ("key", "shape", "unit", "serial", "unit_type", "notes", "sha256", "who", "number", "address", "code", "sealed_by")
)
"""Fields that are keys of the template, or hold names and texts of people."""
VALUE, BY_SOMEBODY = "value", "is_written"
"""Fields of a line of a paper: its value, and whether somebody wrote it."""


def document_in(data: Any, say: Callable[[str], str]) -> Any:
    """Plain dicts and lists with translated texts."""
    match data:
        case str():
            return say(data)
        case dict():
            kept = UNTRANSLATED | {VALUE} if data.get(BY_SOMEBODY) else UNTRANSLATED
            return {key: value if key in kept else document_in(value, say) for key, value in data.items()}
        case list():
            return [document_in(value, say) for value in data]
        case _:
            return data
