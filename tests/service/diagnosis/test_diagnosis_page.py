"""The page of a diagnosis over HTTP: what it says first, and the forms that it holds."""

import json
import re
import zlib

import httpx
import pytest
from sqlalchemy import text as sql

from estimator.json_object import Json
from service.app import create_app
from service.diagnosis.store import Diagnoses
from service.storage import Storage
from tests.conftest import Holding, SettingsHolding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import ALIASES, TEMPERATURE, UNEXPLAINED, drawn, files_of, held, send, warm
from tests.service.made_sessions import session_bytes, session_id
from tests.service.pages.test_http import HTML, MOST_QUERIES, counted
from tests.serving import http_client
from tests.stock import stores

ACCEPT = {"cause": "bias-temperature", "scope": "unit", "by": "K. Ito", "note": "seen twice"}
FIRST = {
    "named": (TEMPERATURE, "The bias of A5 depends on temperature."),
    "a choice": (ALIASES, "A2 has a cubic nonlinearity (9"),
    "unexplained": (UNEXPLAINED, "An effect that no known cause explains"),
}


def page(client: httpx.Client, id: str) -> str:
    """The diagnosis page of a session."""
    answer = client.get(f"/sessions/{id}/diagnosis", headers=HTML)
    assert answer.status_code == 200, answer.text
    return answer.text


@pytest.mark.parametrize("kind", FIRST)
def test_the_page_says_first_what_is_wrong(holding: Holding, kind: str) -> None:
    what, words = FIRST[kind]
    text = page(*held(holding, what))
    assert words in text[text.index("<h1>") : text.index("</h1>")]


def test_a_sound_session_has_nothing_wrong(holding: Holding) -> None:
    assert "Nothing wrong found" in page(holding(session_bytes()), session_id(session_bytes()))


def test_session_and_unit_say_it_in_one_line(holding: Holding) -> None:
    client, id = held(holding, TEMPERATURE)
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    for path in (f"/sessions/{id}", f"/units/{unit}"):
        assert "The bias of A5 depends on temperature." in client.get(path, headers=HTML).text


def page_after(holding: Holding, *, follows: bool) -> str:
    """The page of a unit's second session, in which A2 follows the temperature, as it did in the first or did not."""
    before = json.dumps(warm(1, "2026-01-05T08:00:00Z", follows=follows)).encode()
    now = json.dumps(warm(2, "2026-03-05T08:00:00Z")).encode()
    return page(holding(before, now), session_id(now))


@pytest.mark.parametrize(
    ("follows", "since"),
    [(True, "Present in the earlier sessions too."), (False, "New since the earlier sessions.")],
)
def test_the_page_says_whether_the_cause_is_new(holding: Holding, follows: bool, since: str) -> None:
    assert since in page_after(holding, follows=follows)


def test_the_gain_is_shown_on_the_session_before_too(holding: Holding) -> None:
    text = page_after(holding, follows=True)
    assert "Positions held out" in text
    assert text.index("The session before") > text.index("the session before, of <time")


def test_a_unit_type_without_tolerances_is_diagnosed_like_any_other(holding: Holding) -> None:
    client = holding(json.dumps(warm(1, "2026-01-05T08:00:00Z")).encode())
    name = client.get("/api/v1/units/WARM-1").json()["unit_type"]["name"]
    none = {"tolerances": dict.fromkeys(("scale", "bias", "quadratic", "axis"))}
    client.put(f"/api/v1/unit-types/{name}", json=none).raise_for_status()
    text = page(client, send(client, warm(2, "2026-03-05T08:00:00Z")))
    assert "The bias of A2 depends on temperature." in text
    assert "No verdict: no parameter of this session was judged." in text


def test_what_a_cause_explains_is_no_noise(holding: Holding) -> None:
    document = json.dumps(warm(2, "2026-03-05T08:00:00Z")).encode()
    client, id = holding(document), session_id(document)
    assert "The readings scatter more:" in client.get(f"/sessions/{id}", headers=HTML).text
    text = page(client, id)
    assert "The band is ±2σ of the stated noise." in text
    assert "scatter more" not in text


def test_an_accepted_cause_is_listed_and_the_unit_recomputed(holding: Holding) -> None:
    client, id = held(holding, TEMPERATURE)
    accepted = client.post(f"/sessions/{id}/diagnosis/accept", data=ACCEPT, headers=HTML, follow_redirects=True)
    assert "K. Ito" in accepted.text
    assert "Held-out error of A5" in accepted.text
    assert "Sessions computed again" in accepted.text
    assert "calibrated with it" in page(client, id)


def test_a_program_accepts_it_alike(holding: Holding) -> None:
    client, id = held(holding, TEMPERATURE)
    made = client.post(f"/api/v1/sessions/{id}/diagnosis/accept", json=ACCEPT).raise_for_status()
    [unit] = client.get(f"/api/v1/models/{made.json()['id']}").json()["recomputations"]
    assert (unit["state"], unit["outcome"]["recomputed"] > 0) == ("done", True)


def flags_of(client: httpx.Client, id: str) -> list[Json]:
    """Flags of the unit of a session, on causes."""
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    flags: list[Json] = client.get(f"/api/v1/units/{unit}/flags").json()["flags"]
    return [flag for flag in flags if flag["matter"] == "cause"]


def test_accepting_a_cause_resolves_its_flag_and_withdrawing_it_raises_another(holding: Holding) -> None:
    client, id = held(holding, TEMPERATURE)
    assert [flag["state"] for flag in flags_of(client, id)] == ["raised"]
    made = client.post(f"/api/v1/sessions/{id}/diagnosis/accept", json=ACCEPT).raise_for_status().json()
    [flag] = flags_of(client, id)
    assert flag["state"] == "resolved"
    assert flag["changes"][-1]["text"] == f"Accepted into the model of unit {made['subject']}, revision {made['id']}."
    client.post(f"/api/v1/models/{made['id']}/withdraw", json={"by": "K. Ito", "why": "a mistake"}).raise_for_status()
    assert [flag["state"] for flag in flags_of(client, id)] == ["raised", "resolved"]


def test_accepting_an_equally_possible_cause_resolves_the_flag_too(holding: Holding) -> None:
    client, id = held(holding, ALIASES)
    found = client.get(f"/api/v1/sessions/{id}/diagnosis").json()["findings"][0]
    wanted = ACCEPT | {"cause": found["alternatives"][0]}
    client.post(f"/api/v1/sessions/{id}/diagnosis/accept", json=wanted).raise_for_status()
    assert [flag["state"] for flag in flags_of(client, id)] == ["resolved"]
    kinds = {one["kind"] for one in client.get(f"/api/v1/sessions/{id}").json()["reservations"]}
    assert "cause" not in kinds


def test_the_gain_is_told_in_one_number(holding: Holding) -> None:
    client, id = held(holding, TEMPERATURE)
    told = client.get(f"/api/v1/sessions/{id}/diagnosis").json()["gain_in_words"]
    assert re.fullmatch(r"Held-out error of A5 .*µg \(readings that took no part\)\.", told)
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    for path in (f"/sessions/{id}", f"/sessions/{id}/diagnosis", f"/units/{unit}"):
        assert told in client.get(path, headers=HTML).text


@pytest.mark.parametrize("path", ["/sessions/{id}/diagnosis/accept", "/jobs/recalibration"])
def test_a_form_of_another_site_changes_nothing(holding: Holding, path: str) -> None:
    client, id = held(holding, TEMPERATURE)
    unit = client.get(f"/api/v1/sessions/{id}").json()["unit"]
    foreign = {"Origin": "https://elsewhere.example"}
    assert client.post(path.format(id=id, unit=unit), data=ACCEPT, headers=HTML | foreign).status_code == 403
    assert client.get("/api/v1/models").json()["models"] == []


def test_the_page_asks_few_questions_and_stays_light(settings_holding: SettingsHolding) -> None:
    files = files_of(drawn(TEMPERATURE))
    app = create_app(settings_holding(*files, diagnosed=True))
    with http_client(app) as client, counted(app) as statements:
        assert len(page(client, session_id(files[-1])).encode()) < 500_000
    assert 0 < len(statements) <= MOST_QUERIES


def test_an_accepted_cause_can_be_withdrawn(holding: Holding) -> None:
    client, id = held(holding, TEMPERATURE)
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


def test_a_cause_that_this_version_does_not_know_is_shown_by_its_identifier(settings_holding: SettingsHolding) -> None:
    files = files_of(drawn(TEMPERATURE))
    settings, id = settings_holding(*files, diagnosed=True), session_id(files[-1])
    with stores(settings) as storage, http_client(create_app(settings)) as client:
        page(client, id)
        rename_cause(storage, id, "bias-temperature", "bias-hum")
        text = page(client, id)
        again = client.post(f"/api/v1/sessions/{id}/diagnosis/accept", json=ACCEPT | {"cause": "bias-hum"})
    assert "bias hum (A5)" in text
    assert "cannot be accepted into a model" in text
    assert again.status_code == 422


def rename_cause(storage: Storage, id: str, old: str, new: str) -> None:
    """Makes a stored diagnosis one of a version that called a cause otherwise."""
    with storage.database.reading() as store:
        stored = Diagnoses(store).get(id)
    assert stored is not None
    assert stored.document is not None
    changed = zlib.compress(stored.document.replace(f'"{old}"', f'"{new}"').encode())
    query = sql("UPDATE diagnoses SET document = :changed WHERE session_id = :id")
    with storage.database.engine.begin() as connection:
        connection.execute(query, {"changed": changed, "id": id})
