"""Pydantic's validation errors as messages with their parts."""

from collections.abc import Mapping
from typing import Any

from estimator.message import joined, say, say_count

SENTENCES = {
    "greater_than": "Input should be greater than {gt}",
    "greater_than_equal": "Input should be greater than or equal to {ge}",
    "less_than": "Input should be less than {lt}",
    "less_than_equal": "Input should be less than or equal to {le}",
    "string_pattern_mismatch": "String should match pattern '{pattern}'",
    "literal_error": "Input should be {expected}",
    "enum": "Input should be {expected}",
    "value_error": "Value error, {error}",
    "datetime_parsing": "Input should be a valid datetime, {error}",
    "datetime_from_date_parsing": "Input should be a valid datetime or date, {error}",
    "date_from_datetime_parsing": "Input should be a valid date or datetime, {error}",
    "url_parsing": "Input should be a valid URL, {error}",
}
"""Sentences by type of error; all others have no parts."""
COUNTED = {
    "string_too_short": (
        "String should have at least {n} character",
        "String should have at least {n} characters",
        "min_length",
    ),
    "string_too_long": (
        "String should have at most {n} character",
        "String should have at most {n} characters",
        "max_length",
    ),
    "too_short": (
        "List should have at least {n} item after validation, not {actual_length}",
        "List should have at least {n} items after validation, not {actual_length}",
        "min_length",
    ),
    "too_long": (
        "List should have at most {n} item after validation, not {actual_length}",
        "List should have at most {n} items after validation, not {actual_length}",
        "max_length",
    ),
}
"""Singular, plural, and the counted part."""


def fault_in_words(fault: Mapping[str, Any]) -> str:
    """The message of a validation error, with its parts where they give the same text."""
    message = _with_parts(fault["type"], fault.get("ctx", {}))
    return message if message == fault["msg"] else str(fault["msg"])


def _with_parts(kind: str, parts: Mapping[str, Any]) -> str:
    if kind in COUNTED:
        singular, plural, counted = COUNTED[kind]
        return say_count(singular, plural, parts[counted], **parts)
    if "expected" in parts:
        parts = {**parts, "expected": joined(" or ", str(parts["expected"]).rsplit(" or ", 1))}
    return say(SENTENCES.get(kind, ""), **parts)
