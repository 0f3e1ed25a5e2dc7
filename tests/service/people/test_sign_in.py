"""Somebody signs in with a browser: links, passwords, cookies, forms."""

import re
from collections.abc import Iterator
from datetime import timedelta

import httpx
import pytest

from service.app import create_app
from service.errors import SignInError
from service.kit.person import Role
from service.people.changes import (
    AccountChange,
    LinkForm,
    change_account,
    change_password,
    make_link,
    sign_in,
    use_link,
)
from service.people.store import Accounts
from service.settings import Settings
from service.storage import Storage
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.service.people.staff import NOW, PASSWORD, Staff, staffed, with_password
from tests.serving import http_client

PAGE = {"Accept": "text/html"}


@pytest.fixture
def staff(storage: Storage) -> Staff:
    """One of every role; the engineer has a password."""
    found = staffed(storage)
    with_password(storage, "engineer")
    return found


@pytest.fixture
def http(settings: Settings, staff: Staff) -> Iterator[httpx.Client]:
    """A browser that keeps cookies."""
    with http_client(create_app(settings, clock=lambda: NOW)) as client:
        client.headers.update(PAGE)
        yield client


def enter(http: httpx.Client, password: str = PASSWORD, next: str = "/flags") -> httpx.Response:
    """Sends the form."""
    return http.post("/sign-in", data={"login": "Engineer", "password": password, "next": next})


def test_a_page_leads_to_the_sign_in_and_back(http: httpx.Client) -> None:
    away = http.get("/flags")
    assert (away.status_code, away.headers["location"]) == (303, "/sign-in?next=/flags")
    back = enter(http)
    assert (back.status_code, back.headers["location"]) == (303, "/flags")
    assert http.get("/flags").status_code == 200


def test_the_cookie_is_kept_from_scripts_and_other_sites(http: httpx.Client) -> None:
    cookie = enter(http).headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=lax" in cookie
    assert "Max-Age=43200" in cookie


@one_engine
@pytest.mark.parametrize("next", ["https://evil.example", "//evil.example", "/\\evil.example"])
def test_the_sign_in_leads_nowhere_else(http: httpx.Client, next: str) -> None:
    assert enter(http, next=next).headers["location"] == "/"


def test_a_wrong_password_says_not_what_was_wrong(http: httpx.Client) -> None:
    wrong = enter(http, "not the password")
    unknown = http.post("/sign-in", data={"login": "nobody", "password": PASSWORD})
    assert (wrong.status_code, unknown.status_code) == (401, 401)
    assert "Login or password is wrong" in wrong.text
    assert "Login or password is wrong" in unknown.text


def test_guessing_ends_after_a_few_attempts(http: httpx.Client) -> None:
    assert [enter(http, f"guess {k} of many").status_code for k in range(6)] == [401] * 5 + [429]
    assert enter(http).status_code == 429


def test_a_form_without_the_page_s_own_proof_changes_nothing(http: httpx.Client) -> None:
    enter(http)
    id = http.post("/upload", files={"files": ("a.json", session_bytes())}).status_code
    assert id == 403
    proof = re.search(r'name="csrf" value="([0-9a-f]{64})"', http.get("/account").text)
    assert proof is not None
    sent = http.post(f"/upload?csrf={proof[1]}", files={"files": ("a.json", session_bytes())})
    assert sent.status_code == 200
    note = {"text": "seen", "by": "somebody else"}
    assert http.post("/units/BA-017/notes", data=note).status_code == 403
    assert http.post("/units/BA-017/notes", data=note | {"csrf": proof[1]}).status_code == 303
    assert "Engineer" in http.get("/units/BA-017").text
    assert "somebody else" not in http.get("/units/BA-017").text


def test_a_script_of_a_browser_sends_the_proof_as_a_header(http: httpx.Client) -> None:
    enter(http)
    new = {"label": "bench", "role": "viewer"}
    assert http.post("/api/v1/tokens", json=new).status_code == 403
    proof = re.search(r'name="csrf" value="([0-9a-f]{64})"', http.get("/account").text)
    assert proof is not None
    assert http.post("/api/v1/tokens", json=new, headers={"X-CSRF-Token": proof[1]}).status_code == 201


def test_signing_out_ends_it(http: httpx.Client) -> None:
    enter(http)
    stolen = http.cookies["imu-health"]
    assert http.post("/sign-out").headers["location"] == "/sign-in"
    http.cookies.set("imu-health", stolen)
    assert http.get("/flags").status_code == 303


def test_a_shift_later_one_signs_in_again(settings: Settings, storage: Storage, staff: Staff) -> None:
    secret = sign_in(storage, "engineer", PASSWORD, NOW)
    for later, status in ((timedelta(hours=11), 200), (timedelta(hours=13), 303)):
        with http_client(create_app(settings, clock=lambda later=later: NOW + later)) as client:  # type: ignore[misc]
            assert client.get("/flags", headers=PAGE | {"Cookie": f"imu-health={secret}"}).status_code == status


def test_who_may_no_longer_sign_in_is_out_at_once(http: httpx.Client, storage: Storage) -> None:
    enter(http)
    change_account(storage, "engineer", AccountChange(is_active=False), NOW, who="test")
    assert http.get("/flags").status_code == 303
    assert enter(http).status_code == 401


def test_another_password_ends_every_browser(http: httpx.Client, storage: Storage) -> None:
    enter(http)
    change_password(storage, "engineer", PASSWORD, "another horse entirely", NOW)
    assert http.get("/flags").status_code == 303
    with pytest.raises(SignInError, match="old password"):
        change_password(storage, "engineer", PASSWORD, "yet another horse", NOW)


def test_a_link_works_once_and_looking_does_not_use_it_up(http: httpx.Client, storage: Storage) -> None:
    link = f"/sign-in/{make_link(storage, 'crew', NOW, 'test')}"
    assert "Welcome, Crew" in http.get(link).text
    assert "Welcome, Crew" in http.get(link).text
    assert http.post(link, data={"password": "short"}).status_code == 422
    assert http.post(link, data={"password": PASSWORD}).status_code == 303
    assert http.get("/account").status_code == 200
    assert http.post(link, data={"password": PASSWORD}).status_code == 401


def test_the_first_link_makes_the_first_account_and_no_second(settings: Settings, storage: Storage) -> None:
    links = [make_link(storage, None, NOW, "start") for _ in range(2)]
    use_link(storage, links[0], LinkForm("K.Ito", "K. Ito", PASSWORD), NOW)
    with storage.database.reading() as store:
        (account,) = Accounts(store).every()
    assert (account.login, account.name, account.role, account.has_password) == ("k.ito", "K. Ito", Role.ADMIN, True)
    with pytest.raises(SignInError, match="used already"):
        use_link(storage, links[1], LinkForm("mallory", "", PASSWORD), NOW)


def test_a_password_that_was_chosen_ends_the_other_links(storage: Storage, staff: Staff) -> None:
    links = [make_link(storage, "crew", NOW, "test") for _ in range(2)]
    use_link(storage, links[0], LinkForm("", "", PASSWORD), NOW)
    with pytest.raises(SignInError, match="used already"):
        use_link(storage, links[1], LinkForm("", "", PASSWORD), NOW)


def test_who_finds_a_browser_open_cannot_guess_its_password(http: httpx.Client) -> None:
    enter(http)
    proof = re.search(r'name="csrf" value="([0-9a-f]{64})"', http.get("/account").text)
    assert proof is not None
    guess = {"old": "a guess of many", "new": "another horse entirely", "csrf": proof[1]}
    assert [http.post("/account/password", data=guess).status_code for _ in range(6)] == [401] * 5 + [429]


def test_a_link_ends_after_an_hour(storage: Storage, staff: Staff) -> None:
    link = make_link(storage, "crew", NOW, "test")
    with pytest.raises(SignInError, match="its hour is over"):
        use_link(storage, link, LinkForm("", "", PASSWORD), NOW + timedelta(hours=2))


@one_engine
def test_what_somebody_may_not_do_is_not_offered(http: httpx.Client, storage: Storage) -> None:
    with_password(storage, "viewer")
    http.post("/sign-in", data={"login": "viewer", "password": PASSWORD})
    shown = http.get("/").text
    assert "/upload" not in shown
    assert "/accounts" not in shown
    refused = http.get("/accounts")
    assert (refused.status_code, "viewer is viewer" in refused.text) == (403, True)
