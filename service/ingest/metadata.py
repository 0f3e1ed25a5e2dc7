"""The JSON text that accompanies the columns of a binary file."""

from collections.abc import Mapping, Sequence
from typing import Any

from estimator.json_object import Json
from estimator.reading.json_text import parse_json
from estimator.reading.problems import Problems, cut
from service.kit.limits import in_force, refusal

KEY = "imu-session"
"""Key of the session's other fields in a table's file."""


def with_metadata(text: str, columns: Mapping[str, object], filename: str) -> dict[str, object]:
    """Document of a session: the JSON metadata, with the columns as its table."""
    problems = Problems(filename, in_force().extent)
    document = parse_json(text, problems)
    problems.raise_if_any()
    if "table" in document:
        raise refusal(filename, "is in the {key} metadata; keep the readings in the columns only", "table", key=KEY)
    return document | {"table": dict(columns)}


TEXTS = (
    "format", "unit", "unit_type", "block", "programme", "started_at", "powered_on_at", "operator",
    "notes", "id", "name", "kind", "reading_unit", "counter",
)  # fmt: skip
"""Keys whose value is text even where it looks like a number, as a serial number may."""
DEEPEST = 4
"""Parts of a key; no field of a session has more, and a hostile key could nest without end."""


def last_step(key: str) -> str:
    """The last part of a key."""
    return key.strip().rpartition(".")[2]


def nested(rows: Sequence[tuple[str, float | str | None]], problems: Problems) -> dict[str, object]:
    """The metadata as a document; records keys that are given twice or misplaced."""
    document: Json = {}
    for key, value in rows:
        steps = key.strip().replace("[", ".").replace("]", "").split(".")
        parent = _parent(document, steps)
        if parent is None or steps[-1] in parent:
            problems.add(cut(key), "is given twice, or inside a value that is not an object; keep one")
        else:
            parent[steps[-1]] = _value(value, problems)
    if isinstance(document.get("sensors"), dict):
        document["sensors"] = _listed(document["sensors"], problems)
    return document


def _parent(document: Json, steps: list[str]) -> Json | None:
    node: Any = document
    for step in steps[:-1]:
        node = node.setdefault(step, {})
        if not isinstance(node, dict):
            return None
    return node if len(steps) <= DEEPEST else None


def _value(value: float | str | None, problems: Problems) -> object:
    """Lists and objects stand as JSON in a cell."""
    if isinstance(value, str) and value.lstrip()[:1] in ("[", "{"):
        return parse_json(f'{{"value": {value}}}', problems).get("value")
    return value or None if isinstance(value, str) else value


def _listed(sensors: dict[str, object], problems: Problems) -> list[object]:
    """sensors[1], sensors[2], … in order of their numbers."""
    wrong = [number for number in sensors if not number.isdecimal()]
    for number in wrong:
        problems.add(f"sensors.{cut(number)}", "is not a numbered sensor; write sensors[1].name and so on")
    return [sensors[number] for number in sorted(sensors.keys() - set(wrong), key=lambda n: (len(n), n))]
