"""JSON text → a document. Keys given twice and whatever the parser cannot bear are problems, never crashes."""

import json
import re

from estimator.message import say
from estimator.reading.problems import Problems, cut

MOST_LISTS = 100_000
"""Lists and objects of one text: a table of the most columns takes a tenth, as many sensors as many again."""
FURTHER = 100_000
"""Commas beside those of the table: of the sensors, and within what the operator writes."""
STRUCTURE = re.compile(r'"(?:[^"\\]|\\.)*+"?|[\[{]|[\]}]', re.DOTALL)
"""A text, which may hold brackets, or a bracket. A text without an end runs to the end, so nothing is read twice."""


def parse_json(text: str, problems: Problems) -> dict[str, object]:
    """The object that the text holds; raises FormatError when it holds none."""
    _check_extent(text, problems)
    repeated: list[str] = []

    def as_object(pairs: list[tuple[str, object]]) -> dict[str, object]:
        document = dict(pairs)
        if len(document) < len(pairs):
            repeated.extend(_repeated([key for key, _ in pairs]))
        return document

    try:
        document = json.loads(text, object_pairs_hook=as_object)
    except json.JSONDecodeError as error:
        place = say("line {lineno}, column {colno}", lineno=error.lineno, colno=error.colno)
        raise problems.fail(
            "file", "is not valid JSON at {place}: {msg}; it may be cut short", place=place, msg=error.msg
        ) from error
    except RecursionError as error:
        raise problems.fail("file", "is nested far deeper than any session; check the file") from error
    except ValueError as error:
        raise problems.fail(
            "file", "contains a number of thousands of digits; write numbers as 0.123 or 1e-6"
        ) from error
    for key in repeated:
        problems.add(key, "is given more than once in one object; keep one")
    if not isinstance(document, dict):
        raise problems.fail("file", "must contain one JSON object in braces, with the key format")
    return document


def _check_extent(text: str, problems: Problems) -> None:
    """Raises FormatError where the text would become too much in memory, before it becomes that."""
    most = problems.most
    if text.count(",") > most.cells + FURTHER:
        raise problems.fail("table", "has more than {cells} cells; average or split it", cells=most.cells)
    depth = lists = 0
    for match in STRUCTURE.finditer(text):
        start = text[match.start()]
        if start in "]}":
            depth -= 1
        elif start != '"':
            depth, lists = depth + 1, lists + 1
            if depth > most.nesting:
                raise problems.fail(
                    "file", "is nested deeper than {nesting} levels; check the file", nesting=most.nesting
                )
            if lists > MOST_LISTS:
                raise problems.fail(
                    "file", "contains more than {most_lists} lists; give each column as one list", most_lists=MOST_LISTS
                )


def _repeated(keys: list[str]) -> list[str]:
    seen: set[str] = set()
    twice = [key for key in keys if key in seen or seen.add(key)]  # type: ignore[func-returns-value]
    return [cut(key) for key in dict.fromkeys(twice)]
