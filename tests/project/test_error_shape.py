"""Every error of every route has one shape, in the description and in the answers."""

from pathlib import Path
from typing import Any

import httpx
import pytest

from service.app import create_app
from service.settings import Settings
from tests.databases import one_engine
from tests.serving import http_client

EXAMPLES = {
    "serial": "BA-017",
    "id": "3f9a0c5be1d24786aa10",
    "name": "hex",
    "login": "k.ito",
    "number": "3f9a0c5be1d24786aa10-0-1",
}
NUMBERED = (
    "/api/v1/flags/",
    "/api/v1/models/",
    "/api/v1/notes/",
    "/api/v1/services/",
    "/api/v1/tokens/",
    "/api/v1/webhooks/",
)
"""Paths whose id is a number."""
NEEDS_NO_DATABASE = {"/healthz"}
QUERIES = {"/api/v1/plan": {"unit_type": "RA-6"}}
"""Queries that make a route ask the database; a plan for a cone does not."""
BODIES: dict[str, Any] = {
    "/api/v1/sessions/{id}/diagnosis/accept": {"cause": "bias-ramp", "scope": "unit", "by": "K. Ito"},
    "/api/v1/units/{serial}/diagnosis/accept": {"cause": "beta-eccentricity", "by": "K. Ito"},
    "/api/v1/unit-types/{name}/diagnosis/accept": {"cause": "beta-eccentricity", "by": "K. Ito"},
    "/api/v1/stands/{name}/diagnosis/accept": {"cause": "beta-eccentricity", "by": "K. Ito"},
    "/api/v1/models/{id}/withdraw": {"by": "K. Ito", "why": "seen in error"},
    "/api/v1/units/{serial}/services": {"kind": "repair"},
    "/api/v1/sessions/{id}/withdraw": {"by": "K. Ito", "why": "wrong unit"},
    "/api/v1/sessions/{id}/certificate/signatures": {"number": "1", "meaning": "reviewed", "password": "x" * 12},
    "/api/v1/sessions/{id}/accept": {"by": "K. Ito", "why": "right after all"},
    "/api/v1/sessions/{id}/correct": {"by": "K. Ito"},
    "/api/v1/sessions/{id}/supersede": {"by": "K. Ito", "why": "typing error", "superseded_by": "3f9a0c5be1d24786aa10"},
    "/api/v1/units/{serial}/reference": {"session": "3f9a0c5be1d24786aa10", "by": "K. Ito", "why": "warm"},
    "/api/v1/services/{id}/withdraw": {"by": "K. Ito", "why": "wrong unit"},
    "/api/v1/units/{serial}/lot": {"lot": "2024-07"},
    "/api/v1/units/{serial}/customer": {"name": "Aero Works Ltd", "address": "1 Hangar Road, Derby"},
    "/api/v1/stands/{name}/certificate": {
        "number": "D-K-117",
        "issued_by": "PTB",
        "issued_on": "2025-12-10",
        "valid_until": "2026-12-10",
        "by": "K. Ito",
    },
    "/api/v1/units/{serial}/notes": {"text": "dropped", "by": "K. Ito"},
    "/api/v1/notes/{id}/withdraw": {"by": "K. Ito", "why": "done"},
    "/api/v1/sessions/{id}/stage": {"stage": "as-found", "by": "K. Ito"},
    "/api/v1/webhooks": {"url": "https://example.org/", "secret": "s" * 16, "by": "K. Ito"},
    "/api/v1/flags/{id}/acknowledge": {"by": "K. Ito", "why": "seen"},
    "/api/v1/flags/{id}/resolve": {"by": "K. Ito", "why": "done"},
    "/api/v1/unit-types/{name}": {"tolerances": {"scale": 1e-4, "bias": 1e-4, "quadratic": None, "axis": 1e-4}},
    "/api/v1/accounts": {"login": "k.ito", "role": "admin"},
    "/api/v1/accounts/{login}": {"role": "crew"},
    "/api/v1/tokens": {"label": "bench", "role": "crew"},
    "/api/v1/sessions": {"format": "imu-session/2"},
}


@pytest.fixture(scope="module")
def operations(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, str, dict[str, Any]]]:
    """Method, path and description of every route of the API."""
    app = create_app(Settings(data_folder=tmp_path_factory.mktemp("described")))
    return [
        (method.upper(), path, operation)
        for path, methods in app.openapi()["paths"].items()
        for method, operation in methods.items()
    ]


def test_every_described_error_is_problem_json(operations: list[tuple[str, str, dict[str, Any]]]) -> None:
    described = [
        (method, path, status, list(response.get("content", {})))
        for method, path, operation in operations
        for status, response in operation["responses"].items()
        if status >= "400"
    ]
    assert len(described) > 30
    assert [found for found in described if found[3] != ["application/problem+json"]] == []


def test_every_route_that_asks_the_database_says_that_it_may_be_away(
    operations: list[tuple[str, str, dict[str, Any]]],
) -> None:
    silent = {path for _, path, operation in operations if "503" not in operation["responses"]}
    assert silent == NEEDS_NO_DATABASE


def test_without_a_database_every_route_answers_503_in_the_one_shape(
    operations: list[tuple[str, str, dict[str, Any]]], tmp_path: Path
) -> None:
    folder, hosts = tmp_path / "data", ("example.org",)
    nowhere = Settings(database_url=f"sqlite:///{tmp_path}", data_folder=folder, webhook_hosts=hosts)
    with http_client(create_app(nowhere)) as client:
        for method, path, _ in operations:
            if path not in NEEDS_NO_DATABASE:
                assert_problem(ask(client, method, path), 503)


@one_engine
@pytest.mark.parametrize(
    "path", ["/nothing", "/api/v1/nothing", "/static/nothing.css", "/sessions/none", "/units/none"]
)
def test_what_is_not_there_has_the_one_shape_on_pages_too(client: httpx.Client, path: str) -> None:
    assert_problem(client.get(path), 404)


@one_engine
def test_a_wrong_method_has_the_one_shape_on_every_route(
    client: httpx.Client, operations: list[tuple[str, str, dict[str, Any]]]
) -> None:
    for path in {path for _, path, _ in operations}:
        assert_problem(ask(client, "PATCH", path), 405)


def ask(client: httpx.Client, method: str, path: str) -> httpx.Response:
    """A request that any route takes seriously."""
    body = BODIES.get(path) if method in ("POST", "PUT") else None
    examples = EXAMPLES | ({"id": "1"} if path.startswith(NUMBERED) else {})
    who = {"by": "K. Ito"} if method == "DELETE" else None
    return client.request(method, path.format(**examples), json=body, params=who or QUERIES.get(path))


def assert_problem(answer: httpx.Response, status: int) -> None:
    """The status, in the one shape."""
    assert (answer.status_code, answer.headers["content-type"]) == (status, "application/problem+json"), answer.url
    document = answer.json()
    assert (document["status"], document["type"]) == (status, "about:blank")
    assert document["title"]
    assert document["detail"]
