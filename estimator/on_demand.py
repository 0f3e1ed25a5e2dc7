"""Modules imported on first use: a session on a stand is calibrated without the alignment and its filter.

Most of what Python would import for the package is for what a single use does not touch. The type checker is shown
ordinary imports beside every use of these, and so are the checks of which way imports run.
Source: attributes of a module on demand, PEP 562; lazy loading, SPEC 1 of the Scientific Python projects.
"""

from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from typing import Any


def names_on_demand(package: str, rooms: Mapping[str, str]) -> Callable[[str], Any]:
    """The ``__getattr__`` of a package, from its rooms, each with the names that it holds, parted by spaces."""
    homes = {name: room for room, names in rooms.items() for name in names.split()}

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(f"{package}.{homes[name]}"), name)

    return get


class ModuleOnDemand:
    """A module that is imported when the first of its names is looked up."""

    def __init__(self, home: str) -> None:
        self._home = home

    def __getattr__(self, name: str) -> Any:
        return getattr(import_module(self._home), name)


def function_on_demand(home: str, name: str) -> Callable[..., Any]:
    """A function that stands for another, whose module is imported when it is first called."""

    @cache
    def target() -> Any:
        return getattr(import_module(home), name)

    def call(*arguments: Any, **options: Any) -> Any:
        return target()(*arguments, **options)

    return call
