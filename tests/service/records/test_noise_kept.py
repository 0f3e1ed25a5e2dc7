"""Noise from the rests of a raw log is kept beside bias and scale, and judged by nobody."""

import json

import httpx
import pytest
import yaml

from estimator.allan.results import TERMS
from service.records.diagnose import diagnose
from service.records.keep import keep_noise
from service.sessions.calibrations_store import SessionNoises
from service.sessions.history_store import History, HistoryQuery
from service.storage import Storage
from service.units.store import Units
from service.uploads.receive import upload
from tests.builders import raw_log
from tests.databases import one_engine
from tests.service.made_records import NOW
from tests.service.made_sessions import session_bytes

WHITE = 1e-3 * 0.1
"""m/s²/√Hz of `raw_log`."""


def kept(storage: Storage, month: int = 3, noise: float = 1e-3, **changes: int) -> str:
    """A raw log whose noise was worked out."""
    log = raw_log(still=300, noise=noise, seed=month, **changes) | {"started_at": f"2026-{month:02d}-04T09:00:00Z"}
    id = upload(storage, json.dumps(log).encode(), "log.json", NOW).id
    keep_noise(storage, id, NOW)
    return id


def test_the_terms_are_parameters_of_the_history(storage: Storage) -> None:
    kept(storage)
    with storage.database.reading() as store:
        unit = Units(store).key("LOG-1")
        judged, all_of_it = (History(store).points(unit, HistoryQuery(noise=n)) for n in (False, True))
        (white,) = History(store).points(unit, HistoryQuery(parameter="white-noise", sensor="A1"))
    assert {point.parameter for point in all_of_it} - {point.parameter for point in judged} == set(TERMS)
    assert None not in (white.value, white.lower, white.upper)
    assert white.lower < WHITE < white.upper
    assert (white.tolerance, white.verdict) == (None, "undecidable")


def test_a_term_that_the_rests_do_not_reach_has_no_number(storage: Storage) -> None:
    kept(storage)
    with storage.database.reading() as store:
        walks = History(store).points(Units(store).key("LOG-1"), HistoryQuery(parameter="random-walk"))
    assert [walk.value for walk in walks] == [None] * 3


def test_another_model_revision_has_the_same_noise(storage: Storage) -> None:
    id = kept(storage)
    with storage.database.writing() as store:
        SessionNoises(store).carry({id: 7})
        SessionNoises(store).carry({id: 7})
        again = History(store).points(Units(store).key("LOG-1"), HistoryQuery(parameter="white-noise"))
    assert len(again) == 3
    with storage.database.reading() as store:
        found = SessionNoises(store).get(id)
    assert found is not None
    assert (found.rests, [s.name for s in found.sensors]) == (12, ["A1", "A2", "A3"])


@one_engine
def test_it_is_made_beside_the_diagnosis_of_whatever_holds_rests(storage: Storage) -> None:
    log = raw_log(orientations=8) | {"unit": "LOG-2"}
    ids = [upload(storage, content, "a.json", NOW).id for content in (session_bytes(), json.dumps(log).encode())]
    for id in ids:
        diagnose(storage, id, NOW)
    with storage.database.reading() as store:
        assert [SessionNoises(store).has(id) for id in ids] == [False, True]


@one_engine
@pytest.mark.parametrize(("factor", "said"), [(1.0, False), (1.6, True)])
def test_the_page_says_what_became_noisier(storage: Storage, client: httpx.Client, factor: float, said: bool) -> None:
    kept(storage, 3)
    kept(storage, 4)
    kept(storage, 5, noise=1e-3 * factor)
    page = client.get("/units/LOG-1").text
    assert "Noise at rest" in page
    assert ("White noise N has grown in all accelerometers, 1." in page) == said
    assert (" times. Check the bench" in page) == said


@one_engine
def test_kalibr_is_given_what_the_rests_decide(storage: Storage, client: httpx.Client) -> None:
    id = kept(storage)
    text = client.get(f"/api/v1/sessions/{id}/export", params={"system": "kalibr", "force": "true"}).text
    found = yaml.safe_load(text)["imu0"]
    assert found["accelerometer_noise_density"] == pytest.approx(WHITE, rel=0.2)
    assert "accelerometer_random_walk" not in found
    assert "not decided by this session" in text


@one_engine
def test_programs_ask_for_it_like_for_any_parameter(storage: Storage, client: httpx.Client) -> None:
    kept(storage)
    asked = client.get("/api/v1/units/LOG-1/history", params={"parameter": "white-noise", "sensor": "A2"}).json()
    assert [point["parameter"] for point in asked["points"]] == ["white-noise"]
    (session,) = {point["session"] for point in asked["points"]}
    curves = client.get(f"/api/v1/sessions/{session}/noise").json()
    assert (curves["format"], curves["rests"], len(curves["sensors"])) == ("imu-noise/1", 12, 3)
    assert client.get("/api/v1/sessions/none/noise").status_code == 404
    table = client.get("/api/v1/units/LOG-1/history", params={"format": "csv"}).text
    assert "bias-instability" in table
