"""A mistake of the program is caught at one place: whoever else catches one hides it."""

import ast

from tests.project.source import PACKAGES, ROOT, Module, modules

MISTAKES = {"Exception", "AssertionError", "AttributeError", "NameError"}
"""Exceptions that no input and no store can end in."""
PLACES = {
    "service/kit/guard.py": "the boundary of work beside the requests",
    "service/ingest/hdf5.py": "what h5py raises on damaged files",
    "service/ingest/logs/ulog.py": "what pyulog raises on damaged files",
}


def caught(module: Module) -> bool:
    """Whether a mistake stands in an ``except`` or in a tuple for one."""
    if not any(name in module.path.read_text("utf-8") for name in MISTAKES):
        return False
    nodes = [*ast.walk(module.tree)]
    kinds = [node.type for node in nodes if isinstance(node, ast.ExceptHandler) and node.type]
    tuples = [node for node in nodes if isinstance(node, ast.Tuple)]
    names = [name for node in (*kinds, *tuples) for name in ast.walk(node) if isinstance(name, ast.Name)]
    return any(name.id in MISTAKES for name in names)


def test_a_mistake_is_caught_at_one_place() -> None:
    found = {str(module.path.relative_to(ROOT)) for module in modules(*PACKAGES) if caught(module)}
    assert found == set(PLACES)
