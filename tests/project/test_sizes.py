"""Pieces stay small: no file over 400 lines and no function over 60."""

import ast
import re

from tests.project.source import PACKAGES, modules, statements

LONGEST_FILE = 400
LONGEST_FUNCTION = 60
ALL = modules(*PACKAGES, "tests", "benchmarks")


def test_no_file_is_too_long() -> None:
    lengths = {module.name: len(module.path.read_text("utf-8").splitlines()) for module in ALL}
    assert {name: length for name, length in lengths.items() if length > LONGEST_FILE} == {}


def test_no_function_is_too_long() -> None:
    found = {
        f"{module.name}.{node.name}": node.end_lineno - node.lineno + 1
        for module in ALL
        for node in statements(module.tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.end_lineno is not None
    }
    assert {name: length for name, length in found.items() if length > LONGEST_FUNCTION} == {}


def test_every_module_and_public_function_says_what_it_is() -> None:
    """Classes of the service too; a cause of the estimator says it in its own words, as attributes."""
    bare = [module.name for module in ALL if re.match(r'(?!r?"""|$)', module.path.read_text("utf-8"))]
    bare += [
        f"{module.name}.{node.name}"
        for module in modules(*PACKAGES)
        for node in module.tree.body
        if isinstance(node, ast.FunctionDef | (ast.ClassDef if module.name.startswith("service") else ast.FunctionDef))
        and not node.name.startswith("_")
        and ast.get_docstring(node) is None
    ]
    assert bare == []
