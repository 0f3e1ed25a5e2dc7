"""Views of lists that are kept under a name: for oneself, or for everybody."""

from collections.abc import Iterator

import httpx
import pytest
from lxml import html

from service.app import create_app
from service.kit.person import Role
from service.people import keep_view
from service.settings import Settings
from service.storage import Storage
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.service.people.staff import NOW, Staff, staffed
from tests.serving import http_client

VIEWS = "/api/v1/views"
NEW = {"page": "fleet", "name": "overdue on S1", "query": "due=overdue&stand=S1", "by": "K. Ito"}


def names(client: httpx.Client, **query: str) -> list[str]:
    return [view["name"] for view in client.get(VIEWS, params=query).json()["views"]]


def links(client: httpx.Client, address: str) -> list[tuple[str, str | None]]:
    """The saved views above a list, and which of them is shown."""
    found = html.fromstring(client.get(address).text).xpath("//nav[@aria-label='Saved views']/a")
    return [(link.get("href"), link.get("aria-current")) for link in found]


def test_where_nobody_signs_in_a_view_is_everybody_s_and_replaced_by_its_name(client: httpx.Client) -> None:
    kept = [client.post(VIEWS, json=NEW | {"query": query}).json() for query in (NEW["query"], "due=30")]
    assert kept[0]["id"] == kept[1]["id"]
    assert (kept[1]["url"], kept[1]["shared"]) == ("/?due=30", True)
    assert names(client, page="flags") == []
    assert client.delete(f"{VIEWS}/{kept[0]['id']}", params={"by": "K. Ito"}).status_code == 204
    assert names(client) == []
    assert [line["action"] for line in client.get("/api/v1/audit").json()["lines"]] == [
        "remove view",
        *2 * ["save view"],
    ]


def test_a_view_is_saved_shown_and_removed_on_its_page(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes())
    said = {"page": "fleet", "name": "Стенд 1", "query": "stand=S1&page=3&odd=1", "by": "K. Ito"}
    assert client.post("/views", data=said).headers["location"] == "/?stand=S1"
    assert links(client, "/?stand=S1&page=2") == [("/?stand=S1", "true")]
    assert links(client, "/") == [("/?stand=S1", None)]
    assert "Save this view" not in client.get("/?stand=S1").text
    assert "Save this view" in client.get("/?stand=S2").text
    id = client.get(VIEWS).json()["views"][0]["id"]
    assert client.post(f"/views/{id}/remove", data={"by": "K. Ito"}).headers["location"] == "/?stand=S1"
    assert links(client, "/") == []


@one_engine
def test_a_query_that_no_list_understands_spoils_no_page(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes())
    for page, query in (("fleet", "page=x&q=" + 300 * "a"), ("flags", "after=%00"), ("sessions", "%ff=1&since=x")):
        assert client.post(VIEWS, json=NEW | {"page": page, "query": query}).status_code == 201
    assert [len(links(client, address)) for address in ("/", "/flags", "/sessions")] == [1, 1, 1]
    assert client.post(VIEWS, json=NEW | {"query": "a b"}).status_code == 422


@one_engine
def test_there_are_not_more_than_can_be_chosen_from(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(keep_view, "MAX_VIEWS", 1)
    assert [client.post(VIEWS, json=NEW | {"name": name}).status_code for name in "aab"] == [201, 201, 409]


@pytest.fixture
def signed_in(settings: Settings, storage: Storage) -> Iterator[tuple[httpx.Client, Staff]]:
    """A service with an account of every role."""
    required = settings.model_copy(update={"sign_in": "required"})
    with http_client(create_app(required, clock=lambda: NOW)) as client:
        yield client, staffed(storage)


def test_one_s_own_views_are_nobody_else_s(signed_in: tuple[httpx.Client, Staff]) -> None:
    client, staff = signed_in
    viewer, crew = staff.headers(Role.VIEWER), staff.headers(Role.CREW)
    own = client.post(VIEWS, json=NEW, headers=viewer).json()
    assert own["shared"] is False
    client.headers = crew
    assert names(client) == []
    assert client.delete(f"{VIEWS}/{own['id']}", params={"by": "x"}).status_code == 404
    shared = client.post(VIEWS, json=NEW | {"shared": True}).json()["id"]
    client.headers = viewer
    assert names(client) == [NEW["name"], NEW["name"]]
    assert client.delete(f"{VIEWS}/{shared}", params={"by": "x"}).status_code == 403
    assert client.post(VIEWS, json=NEW | {"shared": True}).status_code == 403
