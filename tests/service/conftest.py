"""What the tests of the service share: a service with a flag, and the log as programs read it."""

import io
import logging
from collections.abc import Iterator

import httpx
import pytest

from service.log import write_log
from tests.conftest import Holding
from tests.service.sessions import FAILED


@pytest.fixture
def flagged(holding: Holding) -> httpx.Client:
    """A unit whose second session has A3 out of tolerance."""
    return holding(*FAILED)


@pytest.fixture
def written() -> Iterator[io.StringIO]:
    """What the log writes for a program."""
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    root.handlers.clear()
    stream = io.StringIO()
    write_log(stream)
    yield stream
    root.handlers[:] = handlers
    root.setLevel(level)
