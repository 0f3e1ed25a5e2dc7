"""Flags are given to people: by login or name where there are accounts, by any name where there are none."""

from collections.abc import Iterator

import httpx
import pytest

from service.app import create_app
from service.kit.person import Role
from service.people.changes import add_account
from service.storage import Storage
from tests.conftest import SettingsHolding
from tests.databases import one_engine
from tests.service.made_sessions import FAILED
from tests.service.people.staff import NOW, Staff, staffed
from tests.serving import http_client
from tests.stock import stores

FLAGS = "/api/v1/flags"
SAID = {"by": "K. Ito", "to": "M. Sato"}


def only(client: httpx.Client, **query: str) -> list[dict[str, object]]:
    found: list[dict[str, object]] = client.get(FLAGS, params=query).json()["flags"]
    return found


def test_a_flag_is_given_and_its_life_and_the_audit_keep_it(flagged: httpx.Client) -> None:
    id = only(flagged)[0]["id"]
    given = flagged.post(f"{FLAGS}/{id}/assign", json=SAID | {"why": "knows the stand"}).json()
    assert given["assignee"] == "M. Sato"
    assert [(c["kind"], c["who"], c["text"]) for c in given["changes"]][1:] == [
        ("flag.assigned", "K. Ito", "To M. Sato. knows the stand")
    ]
    line = flagged.get("/api/v1/audit").json()["lines"][0]
    assert (line["action"], line["details"]["to"]) == ("flag.assigned", "M. Sato")


def test_given_twice_is_given_once_and_taken_off_again(flagged: httpx.Client) -> None:
    id = only(flagged)[0]["id"]
    for to in ("M. Sato", "M. Sato", ""):
        flagged.post(f"{FLAGS}/{id}/assign", json=SAID | {"to": to})
    flag = only(flagged, assigned="nobody")[0]
    assert flag["assignee"] == ""
    assert len(flag["changes"]) == 3


def test_a_resolved_flag_is_nobody_s_matter(flagged: httpx.Client) -> None:
    id = only(flagged)[0]["id"]
    flagged.post(f"{FLAGS}/{id}/resolve", json={"by": "K. Ito", "why": "done"})
    assert flagged.post(f"{FLAGS}/{id}/assign", json=SAID).status_code == 409
    assert flagged.post(f"{FLAGS}/assign", json=SAID | {"flags": [id]}).json() == {"changed": 0}


def test_where_nobody_signs_in_nobody_is_me(flagged: httpx.Client) -> None:
    assert flagged.get(FLAGS, params={"assigned": "me"}).status_code == 422
    assert 'value="me"' not in flagged.get("/flags").text
    assert flagged.get("/flags?assigned=me").status_code == 200


@pytest.fixture
def staffed_flag(settings_holding: SettingsHolding) -> Iterator[tuple[httpx.Client, Staff, Storage]]:
    """A service with one flag and an account of every role."""
    settings = settings_holding(*FAILED).model_copy(update={"sign_in": "required"})
    with stores(settings) as storage, http_client(create_app(settings, clock=lambda: NOW)) as client:
        yield client, staffed(storage), storage


def test_an_account_finds_its_own_flags_even_when_it_is_renamed(
    staffed_flag: tuple[httpx.Client, Staff, Storage],
) -> None:
    client, staff, _ = staffed_flag
    client.headers = staff.headers(Role.ENGINEER)
    id = only(client)[0]["id"]
    assert client.post(f"{FLAGS}/{id}/assign", json=SAID | {"to": "crew"}).json()["assignee"] == "Crew"
    client.put("/api/v1/accounts/crew", json={"name": "M. Sato"}, headers=staff.headers(Role.ADMIN))
    client.headers = staff.headers(Role.CREW)
    assert [flag["id"] for flag in only(client, assigned="me")] == [id]
    client.headers = staff.headers(Role.ENGINEER)
    assert only(client, assigned="me") == []


@one_engine
def test_a_name_that_no_account_has_or_several_have_is_refused(
    staffed_flag: tuple[httpx.Client, Staff, Storage],
) -> None:
    client, staff, storage = staffed_flag
    client.headers = staff.headers(Role.ENGINEER)
    for login in ("m.sato", "m.sato.2"):
        add_account(storage, login, "M. Sato", Role.CREW, NOW, who="test")
    id = only(client)[0]["id"]

    def answer(to: str) -> str:
        faults = client.post(f"{FLAGS}/{id}/assign", json=SAID | {"to": to}).json()["problems"]
        return str(faults[0]["message"])

    assert "no account" in answer("M. Satoh")
    assert "several accounts" in answer("M. Sato")
