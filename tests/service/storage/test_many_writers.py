"""Many who upload at once to one SQLite database: each waits for its turn, and nobody is refused."""

from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest

from service.settings import Settings
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.serving import TLS, serving

CLIENTS = 32


@pytest.mark.slow
@one_engine
def test_nobody_of_thirty_two_is_refused(settings: Settings) -> None:
    def send(number: int) -> int:
        with httpx.Client(base_url=address, timeout=None, verify=TLS) as client:
            return client.post("/api/v1/sessions", content=session_bytes(unit=f"BA-{number:03}", m=3)).status_code

    with serving(settings) as address, ThreadPoolExecutor(CLIENTS) as pool:
        answers = list(pool.map(send, range(CLIENTS)))
    assert answers == [201] * CLIENTS
