"""The project's own source. Trees are parsed when they are looked at and not kept: all of them are half a gigabyte."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("estimator", "service", "migrations")


@dataclass(frozen=True)
class Module:
    """One file of Python."""

    name: str
    """Dotted; of a package the package's."""
    path: Path
    is_package: bool

    @property
    def tree(self) -> ast.Module:
        """Parsed anew each time."""
        return ast.parse(self.path.read_text("utf-8"))

    @cached_property
    def texts(self) -> tuple[str, ...]:
        """The module's strings that are no docstrings."""
        nodes = tuple(ast.walk(self.tree))
        bare = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
        plain = (node.value for node in nodes if isinstance(node, ast.Constant) and id(node) not in bare)
        return tuple(text for text in plain if isinstance(text, str))

    @cached_property
    def imports(self) -> frozenset[str]:
        """Dotted names that it imports; of ``from x import y`` the module x, and x.y where that is a module."""
        return frozenset(name for node in statements(self.tree) for name in _imported(node))


def statements(node: ast.AST) -> Iterator[ast.AST]:
    """Statements inside, at every depth, without their expressions, which are most of a tree."""
    for name in ("body", "handlers", "orelse", "finalbody", "cases"):
        for inner in getattr(node, name, ()):
            yield inner
            yield from statements(inner)


def _imported(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        assert node.module is not None, "relative imports are not used"
        modules = [f"{node.module}.{alias.name}" for alias in node.names]
        found = [name for name in modules if _file(name)]
        yield from found
        if len(found) < len(modules):
            yield node.module


@cache
def _file(name: str) -> bool:
    base = ROOT.joinpath(*name.split("."))
    return base.with_suffix(".py").is_file() or (base / "__init__.py").is_file()


@cache
def modules(*packages: str) -> tuple[Module, ...]:
    """Every module of some packages."""
    paths = [path for package in packages for path in sorted((ROOT / package).rglob("*.py"))]
    return tuple(_module(path) for path in paths)


def _module(path: Path) -> Module:
    parts = path.relative_to(ROOT).with_suffix("").parts
    is_package = parts[-1] == "__init__"
    name = ".".join(parts[:-1] if is_package else parts)
    return Module(name, path, is_package)
