"""Every route of the service, for every role: who may not is turned away before anything is done."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import httpx
import pytest
from fastapi.routing import iter_route_contexts

from service.app import create_app
from service.kit.arriving_files import DEMONSTRATION
from service.kit.person import Role
from service.people.access import NEEDED, Route
from service.people.admission import SIGN_IN_FIRST
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.service.people.staff import NOW, Staff, staffed
from tests.serving import http_client

WHO: tuple[Role | None, ...] = (None, *Role)
OPENAPI = ("GET", "/openapi.json")
"""FastAPI's own; it tells nothing that the source does not."""
FILLED = {"{serial:path}": "BA-017", "{name:path}": "hex", "{id}": "99", "{revision}": "1", "{login}": "viewer",
          "{name}": "style.css", "{secret}": "x", "{number}": "x-0-1"}  # fmt: skip


@pytest.fixture
def required(settings: Settings) -> Settings:
    """A service that everybody must sign in to."""
    return settings.model_copy(update={"sign_in": "required"})


@pytest.fixture
def staff(storage: Storage) -> Staff:
    """One of every role."""
    return staffed(storage)


@pytest.fixture
def http(required: Settings, staff: Staff) -> Iterator[httpx.Client]:
    """HTTP to it."""
    with http_client(create_app(required, clock=lambda: NOW)) as client:
        yield client


def routes(app: Any) -> set[Route]:
    """Routes of the application, as its route table writes them."""
    found = iter_route_contexts(app.router.routes)
    return {(method, one.path) for one in found for method in one.methods if method != "HEAD"} - {OPENAPI}


def test_every_route_has_a_rule_and_every_rule_a_route(settings: Settings) -> None:
    assert routes(create_app(settings)) == set(NEEDED)


def is_turned_away(http: httpx.Client, route: Route, headers: dict[str, str]) -> bool:
    """Whether an empty request to a route ends before anything is done; the answer to others is not looked at."""
    method, path = route
    for name, value in FILLED.items():
        path = path.replace(name, value)
    answer = http.request(method, path, headers=headers)
    words = (SIGN_IN_FIRST, "This needs the role", "it has no rule")
    return answer.status_code in (401, 403) and any(w in answer.text for w in words)


def test_only_who_may_gets_through(http: httpx.Client, staff: Staff) -> None:
    """The role that a route needs, and the one below it; who may most comes last, and may take an account away."""
    for below, who in pairwise((..., *WHO)):
        for route, needed in NEEDED.items():
            if needed is who:
                assert not is_turned_away(http, route, staff.headers(who)), route
                assert below is ... or is_turned_away(http, route, staff.headers(below)), route


@one_engine
def test_nobody_needs_to_sign_in_on_this_machine_until_there_is_an_account(settings: Settings) -> None:
    with http_client(create_app(settings)) as client:
        assert client.get("/api/v1/me").json() == {"login": "", "name": "", "role": "admin", "token": ""}
        made = client.post("/api/v1/accounts", json={"login": "K.Ito", "role": "admin"})
        assert (made.status_code, made.json()["login"]) == (201, "k.ito")
        assert client.get("/api/v1/units").status_code == 401
        assert client.get("/healthz").status_code == 200


@one_engine
@pytest.mark.parametrize("header", ["X-Forwarded-For", "Forwarded", "X-Real-IP", "Via"])
def test_somebody_behind_a_proxy_on_this_machine_is_not_at_it(settings: Settings, header: str) -> None:
    with http_client(create_app(settings)) as client:
        assert client.get("/api/v1/units", headers={header: "203.0.113.9"}).status_code == 401
        assert client.get("/api/v1/units").status_code == 200


@one_engine
def test_beyond_this_machine_nobody_gets_in_unknown(settings: Settings) -> None:
    wide = settings.model_copy(update={"host": "0.0.0.0"})
    with http_client(create_app(wide)) as client:
        assert client.post("/api/v1/accounts", json={"login": "me", "role": "admin"}).status_code == 401


@one_engine
def test_the_first_account_is_an_admin(settings: Settings) -> None:
    with http_client(create_app(settings)) as client:
        assert client.post("/api/v1/accounts", json={"login": "me", "role": "crew"}).status_code == 409


@one_engine
def test_figures_are_read_with_a_token_of_their_own_and_nothing_else(required: Settings) -> None:
    own = required.model_copy(update={"metrics_token": "figures only please"})
    headers = {"Authorization": "Bearer figures only please"}
    with http_client(create_app(own)) as client:
        assert client.get("/metrics", headers=headers).status_code == 200
        assert client.get("/api/v1/units", headers=headers).status_code == 401
        assert client.get("/metrics").status_code == 401


@one_engine
def test_a_demonstration_may_be_looked_at_and_nothing_else(required: Settings, storage: Storage) -> None:
    upload(storage, session_bytes(origin="simulated"), "a.json", NOW, who=DEMONSTRATION)
    with http_client(create_app(required)) as client:
        assert client.get("/units/BA-017").status_code == 200
        assert client.post("/api/v1/sessions", content=session_bytes(unit="BA-018")).status_code == 401
        upload(storage, session_bytes(unit="BA-018"), "a.json", NOW)
        assert client.get("/api/v1/units/BA-017").status_code == 401
