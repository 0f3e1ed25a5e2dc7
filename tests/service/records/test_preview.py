"""The effect of a service that is entered late is shown before it is recorded, and is the one that then comes."""

from datetime import UTC, datetime
from typing import Any

import httpx
import pytest

from service.errors import RefusedError
from service.flags.store import Flags
from service.fleet.store import Fleet
from service.kit.measures import day_of
from service.records.changes import record_service, withdraw_service
from service.records.derive_again import Deriving
from service.records.preview import preview_service
from service.sessions.states import Step
from service.sessions.store import Sessions
from service.sessions.words.conditions import condition_of
from service.storage import Storage
from service.units.records import ForeseenKind, NewService
from service.units.store import Services, Units
from tests.conftest import Filled, Holding
from tests.service.dated import upload_and_date
from tests.service.made_sessions import FAILED, session_bytes, session_id

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
LATE = NewService("repair", datetime(2026, 1, 15, tzinfo=UTC), "glued", "K. Ito", "A3")
FORM = {"kind": "repair", "at": "2026-01-15T00:00", "by": "K. Ito", "note": "glued", "sensor": "A3"}
SECOND = session_id(FAILED[1])


def failed_and_one_more(storage: Storage) -> None:
    """BA-017 is out of tolerance since its second session, and was measured once more."""
    for content in (*FAILED, session_bytes(seed=7, month=4)):
        upload_and_date(storage, content, "a.json", NOW)


@pytest.fixture
def storage(filled: Filled) -> Storage:
    """The stores of that unit."""
    return filled(failed_and_one_more)


def way(storage: Storage) -> Deriving:
    """Options of the derivation of its records."""
    return Deriving(storage.files, 2.0, NOW)


def state(storage: Storage) -> tuple[Any, ...]:
    """The records that a preview must leave alone."""
    with storage.database.reading() as store:
        unit = Units(store).key("BA-017")
        sessions = Sessions(store).of_unit("BA-017")
        return sessions, Flags(store).open_of(unit), Fleet(store).unit("BA-017"), Services(store).recorded("BA-017")


def test_what_was_foreseen_comes_and_goes_with_the_service(storage: Storage) -> None:
    before = state(storage)
    found = preview_service(storage, way(storage), "BA-017", LATE)
    assert state(storage) == before
    assert found.is_late
    service, _ = record_service(storage, "BA-017", LATE, NOW)
    sessions, flags, unit, _ = state(storage)
    verdicts = {one.session: one.after for one in found.changes if one.kind is ForeseenKind.VERDICT}
    assert SECOND in verdicts
    assert verdicts == {
        now.id: condition_of(now.verdict, is_reference=now.is_reference).word
        for was, now in zip(before[0], sessions, strict=True)
        if (was.verdict, was.is_reference) != (now.verdict, now.is_reference)
    }
    [due] = [one.after for one in found.changes if one.kind is ForeseenKind.DUE]
    assert unit is not None
    assert due == (unit.due_reason if unit.due is None else day_of(unit.due))
    flagged = [(one.what, one.after) for one in found.changes if one.kind is ForeseenKind.FLAG]
    assert flagged == [(before[1][0].summary, flags[0].summary)]
    withdraw_service(storage, way(storage), service.id, Step("K. Ito", NOW, "another unit"))
    again = state(storage)
    assert [one.verdict for one in again[0]] == [one.verdict for one in before[0]]
    assert {one.summary for one in again[1]} == {one.summary for one in before[1]}


def test_a_service_after_every_session_changes_no_verdict(storage: Storage) -> None:
    found = preview_service(storage, way(storage), "BA-017", NewService("repair", NOW))
    assert not found.is_late
    assert not [one for one in found.changes if one.kind is ForeseenKind.VERDICT]


def test_what_cannot_be_recorded_has_no_preview(storage: Storage) -> None:
    with pytest.raises(RefusedError):
        preview_service(storage, way(storage), "BA-017", NewService("repair", LATE.at, sensor="G1"))


@pytest.fixture
def http(holding: Holding) -> httpx.Client:
    """A unit whose second session is out of tolerance."""
    return holding(*FAILED)


def test_the_page_shows_it_before_it_is_recorded(http: httpx.Client) -> None:
    page = http.post("/units/BA-017/services", data=FORM)
    assert page.status_code == 200
    assert "What this service would change" in page.text
    assert http.get("/api/v1/units/BA-017").json()["services"] == []
    sent = http.post("/units/BA-017/services", data=FORM | {"sure": "true"})
    assert (sent.status_code, sent.headers["location"]) == (303, "/units/BA-017#events")
    assert len(http.get("/api/v1/units/BA-017").json()["services"]) == 1


def test_it_is_asked_for_over_http(http: httpx.Client) -> None:
    answer = http.post("/api/v1/units/BA-017/services/preview", json=FORM, headers={"Accept-Language": "ru"})
    assert answer.status_code == 200
    [verdict] = [one for one in answer.json()["changes"] if one["kind"] == "verdict"]
    assert (verdict["session"], verdict["after"]) == (SECOND, "Опорный")
    [flag] = [one for one in answer.json()["changes"] if one["kind"] == "flag"]
    assert (flag["before"], flag["after"]) == ("открыто", "закрыто")
    assert http.get("/api/v1/units/BA-017").json()["services"] == []
