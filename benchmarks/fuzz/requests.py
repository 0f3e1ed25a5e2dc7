"""Extreme numbers in every number that a call of the API takes, as its own description names them."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

from benchmarks.fuzz.extremes import EXTREMES, MARK

Schema = Mapping[str, Any]
NUMBERS = ("number", "integer")
DEEPEST = 8
"""Schemas within each other; deeper ones repeat themselves."""


@dataclass(frozen=True)
class Request:
    """One call with one extreme number."""

    method: str
    path: str
    body: bytes | None
    name: str


def requests(spec: Schema, known: Mapping[str, str]) -> Iterator[Request]:
    """Every number of every call; ``known`` has names of what is stored, by the names that paths give them."""
    for path, calls in spec["paths"].items():
        for method, call in calls.items():
            name = f"{method.upper()} {path}"
            parameters = call.get("parameters", [])
            filled = _filled(path, parameters, known)
            yield from _in_parameters(name, path, parameters, known)
            media = call.get("requestBody", {}).get("content", {}).get("application/json", {})
            yield from _in_body(name, filled, media.get("schema", {}), spec)


def _in_parameters(name: str, path: str, parameters: list[Schema], known: Mapping[str, str]) -> Iterator[Request]:
    method = name.partition(" ")[0]
    for one in parameters:
        if not _is_number(one["schema"]):
            continue
        for number in EXTREMES:
            text = quote(number.strip('"'))
            if one["in"] == "path":
                yield Request(method, _filled(path, parameters, {**known, one["name"]: text}), None, f"{name}: {text}")
            elif one["in"] == "query":
                query = f"{_filled(path, parameters, known)}?{one['name']}={text}"
                yield Request(method, query, None, f"{name}: {one['name']} = {text[:30]}")


def _in_body(name: str, path: str, schema: Schema, spec: Schema) -> Iterator[Request]:
    example = _example(schema, spec, 0)
    for way in _ways(example):
        marked = json.loads(json.dumps(example))
        parent = marked
        for key in way[:-1]:
            parent = parent[key]
        parent[way[-1]] = MARK
        for number in EXTREMES:
            body = json.dumps(marked).replace(f'"{MARK}"', number).encode()
            yield Request(name.partition(" ")[0], path, body, f"{name}: {'.'.join(map(str, way))} = {number[:30]}")


def _filled(path: str, parameters: list[Schema], known: Mapping[str, str]) -> str:
    for one in parameters:
        if one["in"] == "path":
            path = path.replace(f"{{{one['name']}}}", known.get(one["name"], "1"))
    return path


def _is_number(schema: Schema) -> bool:
    return any(one.get("type") in NUMBERS for one in (schema, *schema.get("anyOf", [])))


def _example(schema: Schema, spec: Schema, depth: int) -> Any:
    """A body of that form, with every number in it."""
    if depth > DEEPEST:
        return None
    if "$ref" in schema:
        return _example(spec["components"]["schemas"][schema["$ref"].rpartition("/")[2]], spec, depth + 1)
    for group in ("anyOf", "oneOf", "allOf"):
        if group in schema:
            return _example(schema[group][0], spec, depth + 1)
    if "enum" in schema or "const" in schema:
        return schema.get("const", schema.get("enum", [None])[0])
    if schema.get("type") in NUMBERS:
        return schema.get("examples", [schema.get("minimum", 1)])[0]
    if schema.get("type") == "object":
        return {key: _example(own, spec, depth + 1) for key, own in schema.get("properties", {}).items()}
    if schema.get("type") == "array":
        return [_example(schema["items"], spec, depth + 1)] * max(1, schema.get("minItems", 1))
    return schema.get("examples", ["2026-03-01T09:00:00Z" if schema.get("format") == "date-time" else "x"])[0]


def _ways(node: Any, way: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    if isinstance(node, dict):
        for key, child in node.items():
            yield from _ways(child, (*way, key))
    elif isinstance(node, list):
        yield from _ways(node[0], (*way, 0))
    elif isinstance(node, int | float) and not isinstance(node, bool):
        yield way
