"""The reference of the API, made from the service's own description of it (OpenAPI 3.1): read without a network."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from estimator.message import say

SCHEMAS = "#/components/schemas/"
JSON = "application/json"
WITHOUT = ("401", "403", "422")
"""Answers that nearly every call may give; the head of the page tells of them once."""


@dataclass(frozen=True)
class Field:
    """A parameter of a call, or a field of a body."""

    name: str
    place: str
    """``path``, ``query``, ``header``; empty for a field of a body."""
    kind: str
    schema: str
    """Name of the schema that it is of, which the page leads to; empty of a plain value."""
    needed: bool
    text: str


@dataclass(frozen=True)
class Answer:
    """What a call may answer."""

    status: str
    text: str
    kinds: tuple[str, ...]
    """Media types."""
    schema: str


@dataclass(frozen=True)
class Call:
    """One operation."""

    anchor: str
    method: str
    path: str
    summary: str
    role: str
    """The least role that may; empty where nobody needs one."""
    fields: tuple[Field, ...]
    body: str
    """Name of the schema of what is sent; empty where it is no JSON."""
    body_kinds: tuple[str, ...]
    answers: tuple[Answer, ...]


@dataclass(frozen=True)
class Section:
    """The calls of one subject."""

    name: str
    calls: tuple[Call, ...]


@dataclass(frozen=True)
class Schema:
    """The fields of one kind of document."""

    name: str
    text: str
    fields: tuple[Field, ...]


@dataclass(frozen=True)
class ReferencePage:
    """Everything the reference shows."""

    version: str
    sections: tuple[Section, ...]
    schemas: tuple[Schema, ...]


def reference_page(described: Mapping[str, Any]) -> ReferencePage:
    """The page of an OpenAPI document."""
    sections: dict[str, list[Call]] = {}
    for path, operations in described["paths"].items():
        for method, operation in operations.items():
            call = _call(method.upper(), path, operation)
            sections.setdefault(next(iter(operation.get("tags", ())), "operation"), []).append(call)
    schemas = described["components"]["schemas"]
    return ReferencePage(
        version=described["info"]["version"],
        sections=tuple(Section(name, tuple(calls)) for name, calls in sorted(sections.items())),
        schemas=tuple(_schema(name, schemas[name]) for name in sorted(schemas)),
    )


def _call(method: str, path: str, operation: Mapping[str, Any]) -> Call:
    text, _, role = operation.get("description", "").partition("Needs the role ")
    sent = operation.get("requestBody", {}).get("content", {})
    return Call(
        anchor=f"{method.lower()}{path}".replace("/", "-").replace("{", "").replace("}", ""),
        method=method,
        path=path,
        summary=text.strip() or operation.get("summary", ""),
        role=role.rstrip("."),
        fields=tuple(map(_parameter, operation.get("parameters", ()))),
        body=_schema_of(sent.get(JSON, {}).get("schema", {})),
        body_kinds=tuple(sent),
        answers=tuple(
            _answer(status, said) for status, said in operation["responses"].items() if status not in WITHOUT
        ),
    )


def _parameter(given: Mapping[str, Any]) -> Field:
    schema = given.get("schema", {})
    text = given.get("description") or schema.get("description", "")
    return Field(given["name"], given["in"], _kind(schema), _schema_of(schema), given.get("required", False), text)


def _answer(status: str, said: Mapping[str, Any]) -> Answer:
    content = said.get("content", {})
    first: Mapping[str, Any] = next(iter(content.values()), {})
    return Answer(status, said.get("description", ""), tuple(content), _schema_of(first.get("schema", {})))


def _schema(name: str, schema: Mapping[str, Any]) -> Schema:
    needed = schema.get("required", ())
    fields = tuple(
        Field(field, "", _kind(own), _schema_of(own), field in needed, own.get("description", ""))
        for field, own in schema.get("properties", {}).items()
    )
    return Schema(name, schema.get("description", ""), fields)


def _kind(schema: Mapping[str, Any]) -> str:
    """``list of integer or null``."""
    if "$ref" in schema:
        return str(schema["$ref"]).removeprefix(SCHEMAS)
    for joined in ("anyOf", "oneOf", "allOf"):
        if joined in schema:
            return " or ".join(dict.fromkeys(_kind(one) for one in schema[joined]))
    if "enum" in schema:
        return " | ".join(map(str, schema["enum"]))
    if "const" in schema:
        return str(schema["const"])
    if schema.get("type") == "array":
        return say("list of {schema}", schema=_kind(schema.get("items", {})))
    return str(schema.get("format") or schema.get("type") or "anything")


def _schema_of(schema: Mapping[str, Any]) -> str:
    """The first schema that is named in another."""
    if "$ref" in schema:
        return str(schema["$ref"]).removeprefix(SCHEMAS)
    inner = [*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("allOf", ()), schema.get("items", {})]
    return next(filter(None, (_schema_of(one) for one in inner if one)), "")
