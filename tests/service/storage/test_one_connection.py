"""A request holds one connection to the database at most: all pass where there is only one, and many at once wait for
none that another of them holds."""

from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from functools import partial
from typing import Any

import httpx
import pytest
from fastapi.routing import APIRoute
from sqlalchemy import create_engine, text

from service.app import create_app
from service.kit.person import Role
from service.people.changes import make_token
from service.settings import Settings
from service.storage import engine
from tests.conftest import SettingsHolding
from tests.patience import LONG
from tests.service.made_sessions import FAILED, session_id
from tests.service.people.staff import NOW, Staff, staffed
from tests.serving import TLS, http_client, running
from tests.stock import stores

on_postgresql = pytest.mark.parametrize("databases", ["postgresql"], indirect=True)
"""A writer of SQLite has a turn of its own besides."""
QUESTIONED = FAILED[0].replace(b"BA-017", b"BA-018")
"""The same readings under another serial number."""
PLACES = {"serial": "BA-017", "name": "accelerometer × 6, V", "login": "viewer", "number": "1", "id": "1"}


@pytest.fixture
def one_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pools of one, which say at once that they are empty."""
    one = partial(create_engine, pool_size=1, max_overflow=0)
    monkeypatch.setattr(engine, "create_engine", lambda *args, **kwargs: one(*args, **kwargs | {"pool_timeout": 2.0}))


@pytest.fixture
def full(settings_holding: SettingsHolding) -> Settings:
    """A service with a unit that has a flag, and a questioned session."""
    settings = settings_holding(*FAILED, QUESTIONED)
    with stores(settings) as storage, storage.database.engine.begin() as connection:
        connection.execute(text("SET LOCAL session_replication_role = replica"))  # without triggers
        connection.execute(text("UPDATE record_states SET remedies = NULL"))  # as earlier releases left it
    return settings


@pytest.fixture
def staff(full: Settings) -> Staff:
    """One of every role."""
    with stores(full) as storage:
        return staffed(storage)


def every_route(routes: list[Any]) -> Iterator[APIRoute]:
    """The routes, out of nested routers."""
    for route in routes:
        router = getattr(route, "original_router", None)
        if router is not None:
            yield from every_route(router.routes)
        elif isinstance(route, APIRoute):
            yield route


def address(route: APIRoute) -> Iterator[str]:
    """The route with what there is in its path."""
    path = route.path if not route.include_in_schema or route.path.startswith("/api") else f"/api/v1{route.path}"
    for id in ("1", session_id(FAILED[1]), session_id(QUESTIONED)):
        where = path.replace(":path}", "}").replace("{id}", id)
        for name, value in PLACES.items():
            where = where.replace(f"{{{name}}}", value)
        yield where


@on_postgresql
@pytest.mark.usefixtures("one_connection")
def test_every_request_passes_on_a_single_connection(full: Settings) -> None:
    app, answered, failed = create_app(full, clock=lambda: NOW), Counter[int](), list[tuple[str, str, str]]()
    described = app.openapi()
    with http_client(app) as client:
        assert client.get(f"/api/v1/sessions/{session_id(QUESTIONED)}").json()["state"] == "questioned"
        for route in every_route(app.routes):
            for path in dict.fromkeys(address(route)):
                for method in route.methods:
                    answer = client.request(method, path, **example(described, route, method))
                    if answer.status_code in (500, 503):
                        failed.append((method, path, answer.text))
                    answered[answer.status_code // 100] += 1
    assert failed == []
    assert answered[2] + answered[3] > 120


@on_postgresql
@pytest.mark.usefixtures("one_connection")
def test_a_program_passes_on_a_single_connection(full: Settings, staff: Staff) -> None:
    with http_client(create_app(full, clock=lambda: NOW)) as client:
        client.headers.update(staff.headers(Role.CREW))
        (token,) = client.get("/api/v1/tokens").json()["tokens"]
        assert client.get("/").status_code == 200
        assert client.delete(f"/api/v1/tokens/{token['id']}").status_code == 204


def example(described: dict[str, Any], route: APIRoute, method: str) -> dict[str, Any]:
    """The body sent to a route: the example of its body, or a form with something in every field."""
    operation = described["paths"].get(f"/api/v1{route.path}".replace(":path}", "}"), {}).get(method.lower(), {})
    schema = operation.get("requestBody", {}).get("content", {}).get("application/json", {}).get("schema", {})
    if "$ref" in schema:
        model = described["components"]["schemas"][schema["$ref"].rsplit("/", 1)[1]]
        return {"json": model.get("example", dict.fromkeys(model.get("required", ()), "1"))}
    if method != "POST" or route.include_in_schema:
        return {}
    return {"data": dict.fromkeys(fields(route.dependant), "1") | {"at": "", "by": "K. Ito"}}


def fields(dependant: Any) -> Iterator[str]:
    """Names of the fields of a form."""
    yield from (parameter.alias for parameter in dependant.body_params)
    for inner in dependant.dependencies:
        yield from fields(inner)


@on_postgresql
def test_sixty_who_end_their_own_token_at_once_wait_for_nobody(full: Settings, staff: Staff) -> None:
    with stores(full) as storage:
        week = timedelta(days=7)
        tokens = [make_token(storage, "crew", "a", Role.CREW, NOW, lifetime=week, who="test") for _ in range(60)]
    with (
        running(create_app(full, clock=lambda: NOW)) as url,
        httpx.Client(base_url=url, timeout=LONG, verify=TLS) as http,
    ):

        def end(number: int) -> int:
            token, secret = tokens[number]
            return http.delete(f"/api/v1/tokens/{token.id}", headers={"Authorization": f"Bearer {secret}"}).status_code

        with ThreadPoolExecutor(60) as pool:
            assert set(pool.map(end, range(60))) == {204}
