"""What the tests of the service share: a service with a flag."""

import httpx
import pytest

from tests.conftest import Holding
from tests.service.sessions import FAILED


@pytest.fixture
def flagged(holding: Holding) -> httpx.Client:
    """A unit whose second session has A3 out of tolerance."""
    return holding(*FAILED)
