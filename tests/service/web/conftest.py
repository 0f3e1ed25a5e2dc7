"""A service at an address, on SQLite: nothing here asks the database."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest

from service.settings import Settings
from tests.databases import Databases
from tests.serving import serving

At = Callable[..., str]


@pytest.fixture
def at(sqlite: Databases, tmp_path: Path) -> Iterator[At]:
    """The address of an empty service with settings and limits of one's own."""
    with ExitStack() as opened:

        def start(limits: Mapping[str, float] = MappingProxyType({}), **given: Any) -> str:
            settings = Settings(database_url=sqlite.migrated(), data_folder=tmp_path / "data")
            return opened.enter_context(serving(settings.model_copy(update=given), **limits))

        yield start
