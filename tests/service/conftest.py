"""Fixtures of the service's tests: a service with a flag, the log as programs read it, dates worked out with little
effort, and results worked out once.
"""

import io
import logging
from collections.abc import Iterator

import httpx
import pytest
import vl_convert

from estimator.health import odds, posterior
from service.kit.log import write_log
from service.outlook import changes as outlooks
from service.records import diagnose as diagnoses
from tests.conftest import Holding
from tests.once import once
from tests.service.made_sessions import FAILED


@pytest.fixture(scope="package", autouse=True)
def light_forecasts() -> Iterator[None]:
    """A unit's dates from a fifth of the draws: rough ones do, and they took half of every upload."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(posterior, "DRAWS", posterior.DRAWS // 5)
        patch.setattr(odds, "DRAWS", odds.FEW)
        yield


@pytest.fixture(scope="package", autouse=True)
def worked_out_once() -> Iterator[None]:
    """Causes, outlooks and charts of what was met before."""
    with pytest.MonkeyPatch.context() as patch:
        for room, name in ((diagnoses, "find_causes"), (outlooks, "forecast"), (vl_convert, "vegalite_to_svg")):
            patch.setattr(room, name, once(getattr(room, name)))
        yield


@pytest.fixture
def flagged(holding: Holding) -> httpx.Client:
    """A unit whose second session has A3 out of tolerance."""
    return holding(*FAILED, diagnosed=True)


@pytest.fixture
def written() -> Iterator[io.StringIO]:
    """Output of the log for a program."""
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    root.handlers.clear()
    stream = io.StringIO()
    write_log(stream)
    yield stream
    root.handlers[:] = handlers
    root.setLevel(level)
