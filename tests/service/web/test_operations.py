"""Liveness, readiness, figures; and a database that goes away and comes back."""

from pathlib import Path

import httpx
import pytest
from sqlalchemy import make_url, text

from service.app import create_app
from service.settings import Settings
from service.storage.engine import open_engine
from service.storage.schema import downgrade, upgrade
from tests.databases import PostgresDatabases, one_engine
from tests.service.made_sessions import session_bytes
from tests.serving import http_client


def test_the_service_is_alive_and_ready(client: httpx.Client) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}
    assert client.get("/readyz").json() == {"status": "ready", "reasons": [], "failed": {}}


def test_a_schema_of_another_version_is_not_ready(client: httpx.Client, store_url: str) -> None:
    downgrade(store_url, "base")
    answer = client.get("/readyz")
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "5")
    assert "imu-health db upgrade" in answer.json()["detail"]
    upgrade(store_url)
    assert client.get("/readyz").status_code == 200


def test_a_schema_of_a_newer_version_is_not_ready_and_says_which_version_to_run(
    client: httpx.Client, store_url: str
) -> None:
    engine = open_engine(store_url)
    with engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    engine.dispose()
    answer = client.get("/readyz")
    assert answer.status_code == 503
    assert "run the newer version" in answer.json()["detail"]


@one_engine
def test_figures_count_uploads_and_requests(client: httpx.Client) -> None:
    for _ in range(2):
        client.post("/api/v1/sessions", content=session_bytes())
    figures = client.get("/metrics").text
    assert 'imu_health_uploads_total{result="undecidable"} 1.0' in figures
    assert 'imu_health_uploads_total{result="stored-before"} 1.0' in figures
    assert 'imu_health_request_seconds_count{method="POST",operation="upload_session",status="201"} 1.0' in figures


def test_without_its_database_the_service_says_so_and_comes_back_by_itself(
    postgresql: PostgresDatabases, tmp_path: Path
) -> None:
    url = postgresql.migrated()
    name = make_url(url).database
    settings = Settings(database_url=url, data_folder=tmp_path)
    admin = open_engine(postgresql.server.get_uri()).execution_options(isolation_level="AUTOCOMMIT")
    with http_client(create_app(settings)) as client, admin.connect() as server:
        assert client.get("/api/v1/units").status_code == 200
        server.execute(text(f"ALTER DATABASE {name} ALLOW_CONNECTIONS false"))
        server.execute(text("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = :n"), {"n": name})
        for answer in (client.get("/api/v1/units"), client.post("/api/v1/sessions", content=session_bytes())):
            assert (answer.status_code, answer.headers["retry-after"]) == (503, "5")
            assert answer.headers["content-type"] == "application/problem+json"
        assert client.get("/healthz").status_code == 200
        server.execute(text(f"ALTER DATABASE {name} ALLOW_CONNECTIONS true"))
        assert client.get("/api/v1/units").status_code == 200
        assert client.post("/api/v1/sessions", content=session_bytes()).status_code == 201
    admin.dispose()


@one_engine
def test_a_file_where_no_database_can_be_is_away(tmp_path: Path, settings: Settings) -> None:
    nowhere = settings.model_copy(update={"database_url": f"sqlite:///{tmp_path}"})
    with http_client(create_app(nowhere)) as client:
        assert client.get("/api/v1/units").status_code == 503
        assert client.get("/readyz").status_code == 503


@one_engine
@pytest.mark.parametrize(
    ("method", "path", "status"),
    [("GET", "/api/v1/nothing", 404), ("DELETE", "/api/v1/sessions", 405), ("GET", "/api/v1/units?page=0", 422)],
)
def test_errors_of_the_framework_have_the_same_shape(client: httpx.Client, method: str, path: str, status: int) -> None:
    answer = client.request(method, path)
    assert (answer.status_code, answer.headers["content-type"]) == (status, "application/problem+json")
    assert {"type", "title", "status", "detail"} <= set(answer.json())
