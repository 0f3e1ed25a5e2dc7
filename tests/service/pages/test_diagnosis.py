"""The page "What the simulation gets wrong" over HTTP: what it says first, and the forms that it holds."""

import zlib

import httpx
import pytest
from sqlalchemy import text as sql

from service.app import create_app
from service.settings import Settings
from service.storage import Storage
from tests.service.diagnosed import ALIASES, TEMPERATURE, UNEXPLAINED, drawn, send, send_case, warm
from tests.service.pages.test_http import HTML, MOST_QUERIES, counted
from tests.service.sessions import session_bytes
from tests.serving import http_client

ACCEPT = {"cause": "bias-temperature", "scope": "unit", "by": "K. Ito", "note": "seen twice"}
FIRST = {
    "named": (TEMPERATURE, "The zero of A5 follows the temperature."),
    "a choice": (ALIASES, "Cannot tell which: cubic nonlinearity"),
    "unexplained": (UNEXPLAINED, "Something is there that no known cause explains"),
}


def page(client: httpx.Client, id: str) -> str:
    """The diagnosis page of a session."""
    answer = client.get(f"/sessions/{id}/diagnosis", headers=HTML)
    assert answer.status_code == 200, answer.text
    return answer.text


@pytest.mark.parametrize("kind", FIRST)
def test_the_page_says_first_what_is_wrong(client: httpx.Client, kind: str) -> None:
    what, words = FIRST[kind]
    text = page(client, send_case(client, drawn(what)))
    assert words in text[text.index("<h1>") : text.index("</h1>")]


def test_a_sound_session_has_nothing_wrong(client: httpx.Client) -> None:
    id = client.post("/api/v1/sessions", content=session_bytes()).json()["id"]
    assert "Nothing wrong found" in page(client, id)


def test_session_and_unit_say_it_in_one_line(client: httpx.Client) -> None:
    id = send_case(client, drawn(TEMPERATURE))
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    for path in (f"/sessions/{id}", f"/units/{unit}"):
        assert "The zero of A5 follows the temperature." in client.get(path, headers=HTML).text


def test_the_gain_is_shown_on_the_session_before_too(client: httpx.Client) -> None:
    send(client, warm(1, "2026-01-05T08:00:00Z"))
    text = page(client, send(client, warm(2, "2026-03-05T08:00:00Z")))
    assert "Positions held out" in text
    assert text.index("The session before") > text.index("the session before, of <time")


def test_an_accepted_cause_is_listed_and_the_unit_recomputed(client: httpx.Client) -> None:
    id = send_case(client, drawn(TEMPERATURE))
    accepted = client.post(f"/sessions/{id}/diagnosis/accept", data=ACCEPT, headers=HTML, follow_redirects=True)
    assert "K. Ito" in accepted.text
    assert "calibrated before it" in accepted.text
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    assert client.post(f"/units/{unit}/recalibrate", headers=HTML).status_code == 303
    assert "calibrated with it" in page(client, id)


@pytest.mark.parametrize("path", ["/sessions/{id}/diagnosis/accept", "/units/{unit}/recalibrate"])
def test_a_form_of_another_site_changes_nothing(client: httpx.Client, path: str) -> None:
    id = send_case(client, drawn(TEMPERATURE))
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    foreign = {"Origin": "https://elsewhere.example"}
    assert client.post(path.format(id=id, unit=unit), data=ACCEPT, headers=HTML | foreign).status_code == 403
    assert client.get("/api/v1/models").json()["models"] == []


def test_the_page_asks_few_questions_and_stays_light(settings: Settings) -> None:
    app = create_app(settings)
    with http_client(app) as client, counted(app) as statements:
        id = send_case(client, drawn(TEMPERATURE))
        statements.clear()
        assert len(page(client, id).encode()) < 500_000
        assert len(statements) <= MOST_QUERIES


def test_an_accepted_cause_can_be_withdrawn(client: httpx.Client) -> None:
    id = send_case(client, drawn(TEMPERATURE))
    client.post(f"/sessions/{id}/diagnosis/accept", data=ACCEPT, headers=HTML)
    (model,) = client.get("/api/v1/models").json()["models"]
    form = {"by": "R. Duarte", "why": "the thermometer was at fault"}
    shown = client.post(
        f"/sessions/{id}/diagnosis/withdraw/{model['id']}", data=form, headers=HTML, follow_redirects=True
    )
    assert "by R. Duarte: the thermometer was at fault" in shown.text
    assert "calibrated without it" in shown.text
    again = client.post(f"/api/v1/models/{model['id']}/withdraw", json=form)
    assert again.status_code == 409


def test_a_cause_that_this_version_does_not_know_is_shown_by_its_identifier(
    storage: Storage, client: httpx.Client
) -> None:
    id = send_case(client, drawn(TEMPERATURE))
    page(client, id)
    rename_cause(storage, id, "bias-temperature", "bias-hum")
    text = page(client, id)
    assert "bias hum (A5)" in text
    assert "not a property that a model can hold" in text
    again = client.post(f"/api/v1/sessions/{id}/diagnosis/accept", json=ACCEPT | {"cause": "bias-hum"})
    assert again.status_code == 422


def rename_cause(storage: Storage, id: str, old: str, new: str) -> None:
    """Makes a stored diagnosis one of a version that called a cause otherwise."""
    with storage.database.reading() as store:
        stored = store.diagnoses.get(id)
    assert stored is not None
    assert stored.document is not None
    changed = zlib.compress(stored.document.replace(f'"{old}"', f'"{new}"').encode())
    query = sql("UPDATE diagnoses SET document = :changed WHERE session_id = :id")
    with storage.database.engine.begin() as connection:
        connection.execute(query, {"changed": changed, "id": id})
