"""Every call of the API, by subject, as its OpenAPI description has it."""

from collections.abc import Iterator
from typing import Any

Described = dict[str, Any]
METHODS = ("get", "post", "put", "patch", "delete")


def http_page(described: Described) -> str:
    """One section a subject, one below it a call; then the bodies and answers by name."""
    schemas: Described = described["components"]["schemas"]
    lines = [f"{described['info']['description']}\n"]
    for tag, calls in _by_tag(described).items():
        lines.append(f"## {tag}\n")
        lines += [line for method, path, call in calls for line in _call(method, path, call)]
    lines.append("## Bodies and answers\n")
    lines += [line for name in sorted(schemas) for line in _schema(name, schemas[name])]
    return "\n".join(lines)


def _by_tag(described: Described) -> dict[str, list[tuple[str, str, Described]]]:
    found: dict[str, list[tuple[str, str, Described]]] = {}
    for path, operations in described["paths"].items():
        for method in METHODS:
            if method in operations:
                tag = (operations[method].get("tags") or ["service"])[0]
                found.setdefault(tag, []).append((method.upper(), path, operations[method]))
    return dict(sorted(found.items()))


def _call(method: str, path: str, call: Described) -> Iterator[str]:
    yield f"### {method} `{path}`\n"
    yield f"{call.get('description') or call.get('summary', '')}\n"
    if parameters := call.get("parameters"):
        yield "| parameter | in | type | meaning |\n| --- | --- | --- | --- |"
        for one in parameters:
            name = f"`{one['name']}`" + (" (needed)" if one.get("required") else "")
            yield f"| {name} | {one['in']} | {_cell(_type(one['schema']))} | {_cell(one.get('description', ''))} |"
        yield ""
    if body := call.get("requestBody"):
        yield f"Body: {_contents(body['content'])}\n"
    yield "| answer | meaning | content |\n| --- | --- | --- |"
    for status, answer in call["responses"].items():
        yield f"| {status} | {_cell(answer.get('description', ''))} | {_contents(answer.get('content', {}))} |"
    yield ""


def _contents(content: Described) -> str:
    """``application/json``: of which shape."""
    found = ((kind, _cell(_type(one.get("schema", {})))) for kind, one in content.items())
    return "; ".join(f"`{kind}`" + (f": {shape}" if shape else "") for kind, shape in found)


def _type(schema: Described) -> str:
    """A shape in words, a named one as a link."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f"[{name}](#{_anchor(name)})"
    for one in ("anyOf", "oneOf"):
        if one in schema:
            return " or ".join(dict.fromkeys(_type(option) for option in schema[one]))
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    if "const" in schema:
        return f"`{schema['const']}`"
    if schema.get("type") == "array":
        return f"list of {_type(schema.get('items', {})) or 'anything'}"
    return str(schema.get("format") or schema.get("type") or "")


def _anchor(name: str) -> str:
    """As the generator makes it of the heading."""
    return name.lower()


def _schema(name: str, schema: Described) -> Iterator[str]:
    yield f"### {name}\n"
    if schema.get("description"):
        yield f"{schema['description']}\n"
    if not schema.get("properties"):
        yield f"{_type(schema)}\n"
        return
    needed = schema.get("required", ())
    yield "| field | type | meaning |\n| --- | --- | --- |"
    for field, one in schema["properties"].items():
        is_needed = " (needed)" if field in needed else ""
        yield f"| `{field}`{is_needed} | {_cell(_type(one))} | {_cell(one.get('description', ''))} |"
    yield ""


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
