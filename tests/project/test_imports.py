"""Imports run one way, never in a circle, never inside a function; and each library stays in its place."""

import ast
import inspect
import re
import sys
from collections.abc import Iterator
from importlib import import_module

import pytest

from estimator.on_demand import ModuleOnDemand
from tests.project.source import PACKAGES, Module, modules, statements

SUBJECTS = (
    "errors", "settings", "languages", "kit", "client", "storage", "queue", "ingest", "sessions", "web", "units",
    "types", "stands", "models", "diagnosis", "outlook", "groups", "fleet", "tables", "people",
    "flags", "judging", "opening", "jobs", "records", "planning", "papers", "uploads", "work", "pages", "all_pages",
    "all_api", "app", "demo", "commands", "cli",
)  # fmt: skip
"""The service's subjects, from the ground up: one imports only from those before it."""
EDGE = re.compile(
    r"service\.(pages\b|uploads\.(received|layout)\b"
    r"|(?!commands\b|web\b)(\w+\.)+(\w+_)?(api|pages|sections|schemas|dependencies)$)"
)
"""Routes and what they are made of: they lie with their subject, and stand above all subjects, where a page of one
shows what another knows."""
SERVICE_LAYERS = tuple({subject} for subject in SUBJECTS)
ESTIMATOR_LAYERS = (
    {"json_object"},
    {"message"},
    {"errors", "moments", "on_demand", "wording"},
    {"codec"},
    {"session"},
    {"arrays", "content", "screening", "significance"},
    {"least_squares", "rest_noise", "rotations"},
    {"applied_vector", "coverage", "parameters", "reading", "rest_tilt"},
    {"curves", "static"},
    {"results"},
    {"allan", "forward", "hand_turns", "long_logs", "writing"},
    {"causes"},
    {"simulate", "calibration", "parity"},
    {"alignment", "thermal"},
    {"correction", "diagnosis", "health", "programmes", "readiness"},
    {"groups", "hiding", "nominal_vector", "planning"},
)
HOMES = {
    "sqlalchemy": r"service\.storage\b|service\.\w+\.(\w+_)?(store|tables)$|migrations\b",
    "alembic": r"service\.storage\b|migrations\b",
    "fastapi": r"service\.(web|pages|app|all_pages|all_api)\b|service(\.\w+)+\.(\w+_)?(api|pages|dependencies)$"
    r"|service\.people\.admission$|service\.uploads\.(received$|layout\b)",
    "starlette": r"service\.(web|pages|all_pages)\b|service\.people\.admission$|service\.uploads\.(received$|layout\b)",
    "typer": r"service\.(cli|commands)\b",
    "pyhanko": r"service\.papers\.seal\b",
    "signxml": r"service\.papers\.seal\b",
    "cryptography": r"service\.papers\.seal\b",
    "joserfc": r"service\.people\.oidc\.protocol$",
    "pyulog": r"service\.ingest\.logs\.ulog$",
    "mcap": r"service\.ingest\.logs\.mcap_file$",
    "rosbags": r"service\.ingest\.logs\.ros$",
    "structlog": r"service\.(kit\.log|web\.measured)$",
}
"""Modules in which a library may be imported."""
ALL = modules(*PACKAGES)
NAMES = [module.name for module in ALL]


def layer(part: str, layers: tuple[set[str], ...]) -> int:
    """Layer of a part; a new part must be given one."""
    for number, parts in enumerate(layers):
        if part in parts:
            return number
    raise AssertionError(f"{part} has no place in the layers yet")


def upward(package: str, layers: tuple[set[str], ...]) -> list[str]:
    """Imports within a package that do not go to an earlier layer."""
    found = []
    for module in modules(package):
        if module.name == package:
            continue
        own = "pages" if EDGE.match(module.name) else module.name.split(".")[1]
        for name in module.imports:
            parts = name.split(".")
            if parts[0] != package or len(parts) == 1 or parts[1] == own or not is_part(package, parts[1]):
                continue
            if name.endswith(".tables"):
                continue  # all tables are one schema, which a store may join
            to = "pages" if EDGE.match(name) else parts[1]
            if to != own and layer(to, layers) >= layer(own, layers):
                found.append(f"{module.name} imports {name}")
    return found


def is_part(package: str, name: str) -> bool:
    """Whether a name of a package is a module of it."""
    return any(other.split(".")[:2] == [package, name] for other in NAMES)


def test_the_service_s_imports_run_one_way() -> None:
    assert upward("service", SERVICE_LAYERS) == []


def test_the_estimator_s_imports_run_one_way() -> None:
    assert upward("estimator", ESTIMATOR_LAYERS) == []


MOMENTS = "estimator.moments"
"""It reads dates that files state, and no clock."""


def test_the_estimator_is_pure() -> None:
    allowed = {"estimator", "numpy", "scipy", *sys.stdlib_module_names}
    impure = {"datetime", "time", "sqlite3", "urllib", "socket", "subprocess", "threading", "logging"}
    found = [
        f"{module.name} imports {name}"
        for module in modules("estimator")
        for name in module.imports
        if (root := name.split(".")[0]) not in allowed
        or (root in impure and not reads_files(module) and module.name != MOMENTS)
    ]
    assert found == []


def reads_files(module: Module) -> bool:
    """Reading a session file may look at dates."""
    return module.name.startswith(("estimator.reading", "estimator.writing"))


@pytest.mark.parametrize("library", HOMES)
def test_a_library_stays_in_its_place(library: str) -> None:
    found = [
        module.name
        for module in ALL
        if any(name.split(".")[0] == library for name in module.imports) and not re.match(HOMES[library], module.name)
    ]
    assert found == []


def test_no_import_stands_inside_a_function() -> None:
    found = [
        f"{module.name}:{inner.lineno}"
        for module in ALL
        for node in statements(module.tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        for inner in statements(node)
        if isinstance(inner, ast.Import | ast.ImportFrom)
    ]
    assert found == []


BY_NAME = {
    "estimator.on_demand": "what a single use does not touch",
    "service.records.many": "a library that is not always installed",
    "service.cli": "the command that was asked for",
    "service.people.provider": "a library that is not always installed",
    "service.ingest.logs.readers": "a library that is not always installed",
    "service.papers.sealing": "a library that is not always installed",
}
"""Modules that import by a name, and what."""


def test_nothing_else_is_imported_by_a_name() -> None:
    found = {
        module.name
        for module in ALL
        if re.search("importlib|__import__", module.path.read_text("utf-8"))
        for node in ast.walk(module.tree)
        if (isinstance(node, ast.ImportFrom) and any(alias.name == "import_module" for alias in node.names))
        or (isinstance(node, ast.Import) and any(alias.name == "importlib" for alias in node.names))
        or (isinstance(node, ast.Name) and node.id == "__import__")
    }
    assert found == set(BY_NAME)


def test_what_comes_on_demand_is_what_the_type_checker_is_shown() -> None:
    lazy = [module for module in ALL if "estimator.on_demand" in module.imports]
    assert lazy
    for module in lazy:
        loaded, shown = import_module(module.name), only_shown(module)
        assert {".".join(parts).strip(".") for parts in shown.values()} == set(on_demand(module)), module.name
        for own, (home, name) in shown.items():
            got = getattr(loaded, own)
            if isinstance(got, ModuleOnDemand):
                assert vars(got) == {"_home": f"{home}.{name}".strip(".")}
                continue
            meant = getattr(import_module(home), name)
            assert got is meant or inspect.getclosurevars(got).nonlocals["target"]() is meant


def only_shown(module: Module) -> dict[str, tuple[str, str]]:
    """Imports that only the type checker sees: own name → home and name there; a whole library has none."""
    return {
        alias.asname or alias.name: (getattr(inner, "module", ""), alias.name)
        for node in module.tree.body
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
        for inner in node.body
        if isinstance(inner, ast.ImportFrom | ast.Import)
        for alias in inner.names
    }


def on_demand(module: Module) -> Iterator[str]:
    """Dotted names that a module asks for when they are used."""
    for call in ast.walk(module.tree):
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
            continue
        if call.func.id in ("function_on_demand", "ModuleOnDemand"):
            yield ".".join(map(ast.literal_eval, call.args))
        elif call.func.id == "names_on_demand":
            for room, names in ast.literal_eval(call.args[1]).items():
                yield from (f"{module.name}.{room}.{name}" for name in names.split())


def test_no_imports_go_in_a_circle() -> None:
    graph = {module.name: {name for name in module.imports if name in NAMES} for module in ALL}
    done: set[str] = set()

    def walk(name: str, trail: tuple[str, ...]) -> None:
        assert name not in trail, " → ".join((*trail[trail.index(name) :], name))
        if name not in done:
            for imported in graph[name]:
                walk(imported, (*trail, name))
            done.add(name)

    for name in graph:
        walk(name, ())
