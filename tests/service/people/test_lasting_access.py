"""Access ends when it should: tokens make nothing that outlives them, another password ends access by the old one, and
ended access stays so.
"""

import re
from collections.abc import Iterator

import httpx
import pytest

from service.app import create_app
from service.kit.person import Role
from service.people.changes import make_link
from service.settings import Settings
from service.storage import Storage
from tests.service.people.staff import NOW, PASSWORD, Staff, staffed, with_password
from tests.serving import http_client

API = "/api/v1"
OTHER = "another horse entirely"


@pytest.fixture
def staff(storage: Storage) -> Staff:
    """One of every role."""
    return staffed(storage)


@pytest.fixture
def http(settings: Settings, staff: Staff) -> Iterator[httpx.Client]:
    """A browser that keeps cookies."""
    with http_client(create_app(settings, clock=lambda: NOW)) as client:
        yield client


def signed_in(http: httpx.Client, storage: Storage, login: str = "engineer") -> str:
    """Signs in with a new password, and returns the proof that forms bring back."""
    with_password(storage, login)
    http.post("/sign-in", data={"login": login, "password": PASSWORD})
    proof = re.search(r'name="csrf" value="([0-9a-f]{64})"', http.get("/account").text)
    assert proof is not None
    return proof[1]


def new_token(http: httpx.Client, proof: str) -> tuple[int, dict[str, str]]:
    """Number and headers of a token that somebody signed in makes."""
    new = {"label": "bench", "role": "crew"}
    made = http.post(f"{API}/tokens", json=new, headers={"X-CSRF-Token": proof}).json()
    return made["id"], {"Authorization": f"Bearer {made['secret']}"}


def role_of(http: httpx.Client, headers: dict[str, str]) -> int:
    """Status of a request with a token, whoever the browser is."""
    return httpx.get(f"{http.base_url}{API}/units", headers=headers).status_code


@pytest.mark.parametrize("path", [f"{API}/tokens", "/account/tokens"])
def test_a_token_makes_no_token(http: httpx.Client, staff: Staff, path: str) -> None:
    new = {"label": "for ever", "role": "viewer", "days": 366}
    sent = {"data": new} if path.startswith("/account") else {"json": new}
    refused = http.post(path, headers=staff.headers(Role.ADMIN), **sent)
    assert (refused.status_code, "outlive" in refused.text) == (403, True)


@pytest.mark.parametrize("path", [f"{API}/accounts/crew/link", "/accounts/crew/link", "/accounts"])
def test_a_token_makes_no_sign_in_link(http: httpx.Client, staff: Staff, path: str) -> None:
    new = {"login": "mallory", "name": "M", "role": "admin"} if path == "/accounts" else None
    refused = http.post(path, headers=staff.headers(Role.ADMIN), data=new)
    assert (refused.status_code, "outlive" in refused.text) == (403, True)
    names = [one["login"] for one in http.get(f"{API}/accounts", headers=staff.headers(Role.ADMIN)).json()["accounts"]]
    assert "mallory" not in names


def test_a_token_revokes_itself_and_no_other(http: httpx.Client, staff: Staff) -> None:
    admin = staff.headers(Role.ADMIN)
    numbers = {one["login"]: one["id"] for one in http.get(f"{API}/tokens", headers=admin).json()["tokens"]}
    assert http.delete(f"{API}/tokens/{numbers['crew']}", headers=admin).status_code == 403
    assert http.post(f"/account/tokens/{numbers['crew']}/revoke", headers=admin).status_code == 403
    assert role_of(http, staff.headers(Role.CREW)) == 200
    assert http.delete(f"{API}/tokens/{numbers['admin']}", headers=admin).status_code == 204
    assert role_of(http, admin) == 401


def test_who_is_signed_in_revokes_others_tokens_as_an_administrator(
    http: httpx.Client, storage: Storage, staff: Staff
) -> None:
    proof = signed_in(http, storage, "admin")
    tokens = http.get(f"{API}/tokens").json()["tokens"]
    crew = next(one["id"] for one in tokens if one["login"] == "crew")
    assert http.delete(f"{API}/tokens/{crew}", headers={"X-CSRF-Token": proof}).status_code == 204
    assert role_of(http, staff.headers(Role.CREW)) == 401


def test_another_password_ends_tokens_and_links(http: httpx.Client, storage: Storage) -> None:
    proof = signed_in(http, storage)
    _, token = new_token(http, proof)
    link = make_link(storage, "engineer", NOW, "test")
    assert role_of(http, token) == 200
    changed = http.post("/account/password", data={"old": PASSWORD, "new": OTHER, "csrf": proof})
    assert changed.headers["location"] == "/sign-in"
    assert role_of(http, token) == 401
    assert httpx.get(f"{http.base_url}/sign-in/{link}").status_code == 401


def test_a_password_chosen_by_a_link_ends_tokens(http: httpx.Client, storage: Storage, staff: Staff) -> None:
    assert role_of(http, staff.headers(Role.ENGINEER)) == 200
    link = make_link(storage, "engineer", NOW, "test")
    assert http.post(f"/sign-in/{link}", data={"password": PASSWORD}).status_code == 303
    assert role_of(http, staff.headers(Role.ENGINEER)) == 401


def test_an_account_that_is_active_again_has_no_token_and_no_link(
    http: httpx.Client, storage: Storage, staff: Staff
) -> None:
    admin, link = staff.headers(Role.ADMIN), make_link(storage, "crew", NOW, "test")
    for is_active in (False, True):
        assert http.put(f"{API}/accounts/crew", json={"is_active": is_active}, headers=admin).status_code == 200
    assert role_of(http, staff.headers(Role.CREW)) == 401
    assert http.get(f"/sign-in/{link}").status_code == 401
    line = http.get(f"{API}/audit", params={"subject": "crew"}, headers=admin).json()["lines"][1]
    assert len(line["details"]["tokens"]) == 1


def test_the_same_password_again_is_refused(http: httpx.Client, storage: Storage) -> None:
    proof = signed_in(http, storage)
    same = http.post("/account/password", data={"old": PASSWORD, "new": PASSWORD, "csrf": proof})
    assert (same.status_code, "is the one that the account has" in same.text) == (422, True)
    assert http.get("/account").status_code == 200
    link = make_link(storage, "engineer", NOW, "test")
    assert http.post(f"/sign-in/{link}", data={"password": PASSWORD}).status_code == 422
    assert http.post(f"/sign-in/{link}", data={"password": OTHER}).status_code == 303
