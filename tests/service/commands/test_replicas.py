"""Two of the service behind one address, on one PostgreSQL and one folder: a process as the compose file starts it, and
this one."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest

from service.settings import Settings
from tests.databases import PostgresDatabases
from tests.service.commands.conftest import ENTRYPOINT, started
from tests.service.made_sessions import session_bytes
from tests.serving import serving


@pytest.fixture(scope="module")
def replicas(postgresql: PostgresDatabases, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, str]]:
    """Addresses of two replicas; the schema is there, as it is when a second one joins."""
    shared = Settings(database_url=postgresql.migrated(), data_folder=tmp_path_factory.mktemp("shared"))
    own = {
        "IMU_HEALTH_PORT": "0",
        "IMU_HEALTH_DATABASE_URL": shared.database,
        "IMU_HEALTH_DATA_FOLDER": str(shared.data_folder),
    }
    with started("/bin/sh", ENTRYPOINT, **own) as one, serving(shared) as other:
        yield one, other


@pytest.mark.slow
def test_what_one_stores_the_other_shows(replicas: tuple[str, str]) -> None:
    one, other = replicas
    content = session_bytes()
    stored = httpx.post(f"{one}/api/v1/sessions", content=content).json()["id"]
    assert httpx.get(f"{other}/api/v1/sessions/{stored}/file").content == content
    assert httpx.get(f"{other}/readyz").json()["status"] == "ready"


@pytest.mark.slow
def test_the_same_session_sent_to_both_at_once_is_stored_once(replicas: tuple[str, str]) -> None:
    content = session_bytes(seed=2)

    def send(address: str) -> httpx.Response:
        return httpx.post(f"{address}/api/v1/sessions", content=content)

    with ThreadPoolExecutor(2) as both:
        answers = list(both.map(send, replicas))
    assert sorted(answer.status_code for answer in answers) == [200, 201]
    (stored,) = {answer.json()["id"] for answer in answers}
    listed = httpx.get(f"{replicas[0]}/api/v1/sessions").json()["sessions"]
    assert [session["id"] for session in listed].count(stored) == 1
