"""JSON text → a document. Keys given twice and whatever the parser cannot bear are problems, never crashes."""

import json

from estimator.reading.problems import Problems, cut


def parse_json(text: str, problems: Problems) -> dict[str, object]:
    """The object that the text holds; raises FormatError when it holds none."""
    repeated: list[str] = []

    def as_object(pairs: list[tuple[str, object]]) -> dict[str, object]:
        found = dict(pairs)
        if len(found) < len(pairs):
            repeated.extend(_repeated([key for key, _ in pairs]))
        return found

    try:
        document = json.loads(text, object_pairs_hook=as_object)
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise problems.fail("file", f"is not valid JSON at {place}: {error.msg}; it may be cut short") from error
    except RecursionError as error:
        raise problems.fail("file", "is nested far deeper than any session; check what was written") from error
    except ValueError as error:
        raise problems.fail("file", "holds a number of thousands of digits; write numbers as 0.123 or 1e-6") from error
    for key in repeated:
        problems.add(key, "is given more than once in one object; keep one")
    if not isinstance(document, dict):
        raise problems.fail("file", "must hold one JSON object in braces, with the key format")
    return document


def _repeated(keys: list[str]) -> list[str]:
    seen: set[str] = set()
    twice = [key for key in keys if key in seen or seen.add(key)]  # type: ignore[func-returns-value]
    return [cut(key) for key in dict.fromkeys(twice)]
