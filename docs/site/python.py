"""The public names of a package, as its source says them: signatures, fields, docstrings."""

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from types import ModuleType
from typing import Any

UNDERLINED = re.compile(r"^(\S.*)\n-{3,}$", re.MULTILINE)
"""A heading as numpydoc and our pages of conventions write it."""


def python_page(package: ModuleType) -> str:
    """The docstring of the package, then every public name."""
    names = [line for name in package.__all__ for line in _name(name, getattr(package, name))]
    return "\n".join([f"```text\n{inspect.getdoc(package)}\n```\n", *names])


def _name(name: str, found: Any) -> Iterator[str]:
    yield f"## `{name}`\n"
    node = ast.parse(textwrap.dedent(inspect.getsource(found))).body[0]
    if isinstance(node, ast.ClassDef):
        yield from _class(node)
    elif isinstance(node, ast.FunctionDef):
        yield f"```python\n{_signature(node)}\n```\n"
        yield _doc(node)
    yield f"*{found.__module__}*\n"


def _class(node: ast.ClassDef) -> Iterator[str]:
    bases = f"({', '.join(map(ast.unparse, node.bases))})" if node.bases else ""
    yield f"```python\nclass {node.name}{bases}\n```\n"
    yield _doc(node)
    if fields := list(_fields(node)):
        yield "| field | type | meaning |\n| --- | --- | --- |"
        yield from (f"| `{name}` | `{kind}` | {meaning} |" for name, kind, meaning in fields)
        yield ""
    for method in node.body:
        if isinstance(method, ast.FunctionDef) and not method.name.startswith("_"):
            is_property = any(ast.unparse(one) == "property" for one in method.decorator_list)
            yield f"### `{node.name}.{method.name}`\n"
            yield f"```python\n{_signature(method, is_property=is_property)}\n```\n"
            yield _doc(method)


def _fields(node: ast.ClassDef) -> Iterator[tuple[str, str, str]]:
    """Annotated names with the string that stands under each."""
    for place, field in enumerate(node.body):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
            below = node.body[place + 1] if place + 1 < len(node.body) else None
            text = below.value.value if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant) else ""
            yield field.target.id, _cell(ast.unparse(field.annotation)), _cell(str(text))


def _signature(node: ast.FunctionDef, *, is_property: bool = False) -> str:
    """The signature on one line, or with one argument a line where that is long."""
    answer = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    if is_property:
        return f"{node.name}{answer.replace(' -> ', ': ')}"
    line = f"{node.name}({ast.unparse(node.args)}){answer}"
    if len(line) <= 100:
        return line
    pieces = re.split(r", (?=(?:[^\[\]()]*[\[(][^\[\]()]*[\])])*[^\[\]()]*$)", ast.unparse(node.args))
    return f"{node.name}(\n" + "".join(f"    {piece},\n" for piece in pieces) + f"){answer}"


def _doc(node: ast.FunctionDef | ast.ClassDef) -> str:
    """The docstring: its first paragraphs as prose, tables of parameters as they are written."""
    text = ast.get_docstring(node) or ""
    found = UNDERLINED.search(text)
    if found is None:
        return f"{_prose(text)}\n"
    prose, tables = text[: found.start()], text[found.start() :]
    return f"{_prose(prose)}\n\n```text\n{tables.rstrip()}\n```\n"


def _prose(text: str) -> str:
    return text.strip().replace("``", "`")


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("``", "`").replace("|", "\\|")
