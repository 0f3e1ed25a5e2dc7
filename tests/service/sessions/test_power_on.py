"""The moment of power-on: kept with its session, shown, certified, and asked for the next one anew."""

import httpx
import pytest

from service.uploads.template import EXAMPLE
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.filled import cells, filled
from tests.service.made_sessions import session_bytes, session_id
from tests.service.pages.test_http import HTML
from tests.service.papers.documents import text_of
from tests.service.uploads.test_layouts_page import looked_at, sent

STATED = {"powered_on_at": "2026-03-01T08:20:00Z"}
WORDS = "40 min before the first reading"


@pytest.fixture
def known(holding: Holding) -> tuple[httpx.Client, str]:
    """A service that holds a session of a unit that was on for 40 minutes, and its id."""
    content = session_bytes(**STATED)
    return holding(content, diagnosed=True), session_id(content)


def test_it_is_kept_and_shown(known: tuple[httpx.Client, str]) -> None:
    client, id = known
    assert client.get(f"/api/v1/sessions/{id}").json()["time_since_power_on"] == 2400.0
    assert WORDS in client.get(f"/sessions/{id}", headers=HTML).text


def test_it_stands_among_the_conditions_of_the_certificate(known: tuple[httpx.Client, str]) -> None:
    client, id = known
    assert f"Switched on {WORDS}" in text_of(client.get(f"/api/v1/sessions/{id}/certificate").content)
    conditions = client.get(f"/api/v1/sessions/{id}/certificate", params={"format": "dcc"}).text
    assert "Time since power-on" in conditions
    assert "2400" in conditions


def test_what_is_not_stated_is_not_shown(holding: Holding) -> None:
    client, id = holding(session_bytes(), diagnosed=True), session_id(session_bytes())
    assert client.get(f"/api/v1/sessions/{id}").json()["time_since_power_on"] is None
    assert "Switched on" not in client.get(f"/sessions/{id}", headers=HTML).text
    assert "Switched on" not in text_of(client.get(f"/api/v1/sessions/{id}/certificate").content)


def test_a_template_asks_for_it_anew(known: tuple[httpx.Client, str]) -> None:
    client, _ = known
    template = client.get("/api/v1/session-template", params={"unit": "BA-017"}).content
    keys = {row[0]: row[1] for row in cells(template, "session")}
    assert keys["powered_on_at"] is None
    assert "time_since_power_on_s" not in keys
    asked = {"unit": "BA-017", "started_at": EXAMPLE["started_at"], "powered_on_at": EXAMPLE["powered_on_at"]}
    receipt = client.post("/api/v1/sessions", content=filled(template, asked)).raise_for_status().json()
    assert client.get(f"/api/v1/sessions/{receipt['id']}").json()["time_since_power_on"] == 2400.0


def test_the_form_of_a_table_takes_it(client: httpx.Client) -> None:
    form = looked_at(client, **{"fact.time_since_power_on_s": "2400"})
    answer = sent(client, form, do="store")
    assert answer.status_code == 303, answer.text
    stored = client.get(answer.headers["location"].replace("/sessions", "/api/v1/sessions")).json()
    assert stored["time_since_power_on"] == 2400.0
