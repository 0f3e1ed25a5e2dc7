"""Many sessions that a change leaves to be judged again are judged beside the requests, and it can be read how many."""

from threading import Event

import httpx
import pytest

from service.app import create_app
from service.judging.store import Derivations
from service.records.changes import choose_reference
from service.records.derive_again import derive_again
from service.sessions.states_store import States
from service.sessions.store import Sessions
from service.settings import Settings
from service.storage import Storage
from service.units.store import Units
from service.uploads.receive import upload
from service.work.watch import derive_waiting
from tests.conftest import SettingsHolding
from tests.patience import until
from tests.service.doubtful import MISTAKEN
from tests.service.made_records import NOW, state_of, step, way
from tests.service.made_sessions import session_bytes, session_id
from tests.serving import http_client
from tests.stock import stores

UNIT = "BA-017"


def filled(storage: Storage) -> list[str]:
    """Four sessions."""
    return [upload(storage, session_bytes(seed=m, month=m, a3_moved=20.0 * m), "a.json", NOW).id for m in (1, 2, 3, 4)]


def waiting(storage: Storage) -> int:
    with storage.database.reading() as store:
        return Derivations(store).waiting_of(UNIT)


@pytest.mark.slow
def test_what_is_judged_later_ends_as_what_is_judged_at_once(storage: Storage) -> None:
    ids = filled(storage)
    choose_reference(storage, way(storage, at_once=None), ids[3], step())
    at_once = state_of(storage, UNIT)
    choose_reference(storage, way(storage, at_once=None), ids[0], step())
    _, derived = choose_reference(storage, way(storage, at_once=2), ids[3], step())
    assert (derived.judged, derived.waiting, waiting(storage)) == ((ids[3],), 3, 3)
    derive_waiting(storage, 2.0, lambda: NOW, Event())
    assert waiting(storage) == 0
    assert state_of(storage, UNIT) == at_once


def test_who_is_the_reference_already_is_chosen_without_judging_the_others(storage: Storage) -> None:
    ids = filled(storage)
    _, derived = choose_reference(storage, way(storage), ids[0], step())
    assert derived.judged == (ids[0],)  # says from now on that it was chosen


def said(client: httpx.Client, id: str) -> tuple[bool, list[str]]:
    """Whether a session is the reference, and the reservations of its verdict."""
    found = client.get(f"/api/v1/sessions/{id}").json()
    return found["is_reference"], [one["kind"] for one in found["reservations"]]


def waits(client: httpx.Client) -> int:
    """Number of sessions that are to be judged or weighed."""
    return int(client.get(f"/api/v1/units/{UNIT}/derivation").json()["waiting"])


@pytest.fixture
def working(settings_holding: SettingsHolding) -> Settings:
    """Settings of a service with workers, that holds a reference and a session out of tolerance for a jump that is
    named.
    """
    return settings_holding(*MISTAKEN, diagnosed=True).model_copy(update={"diagnosis_workers": 1})


def test_another_reference_is_answered_with_what_verdicts_are_said_with_then(working: Settings) -> None:
    id = session_id(MISTAKEN[-1])
    with http_client(create_app(working)) as client:
        assert said(client, id) == (False, ["cause", "other-model", "stated-errors"])
        chosen = {"session": id, "by": "K. Ito", "why": "the first one was cold"}
        client.post(f"/api/v1/units/{UNIT}/reference", json=chosen).raise_for_status()
        assert (waits(client), said(client, id)) == (0, (True, ["cause"]))


def test_what_a_killed_service_left_is_weighed_after_its_next_start(working: Settings) -> None:
    id = session_id(MISTAKEN[-1])
    with stores(working) as storage, storage.database.writing() as store:
        States(store).choose(Units(store).hold(UNIT), id, step())
        derive_again(store, way(storage), UNIT, Sessions(store).get(id).started_at, (id,))
    with http_client(create_app(working)) as client:
        until(lambda: waits(client) == 0)
        assert said(client, id) == (True, ["cause"])
