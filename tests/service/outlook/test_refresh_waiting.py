"""A unit's outlook is worked out beside the requests that change its history, and is what it would be within them."""

from collections.abc import Iterator
from datetime import UTC, datetime
from threading import Event
from typing import Any

import pytest

from service.app import create_app
from service.flags.store import Flags
from service.judging.records import Usable
from service.judging.usable_reading import usable_unit as usable
from service.judging.usable_words import DATES_PENDING
from service.kit.bell import Bell
from service.kit.metrics import Metrics
from service.outlook.store import Outlooks
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.changes import withdraw_session
from service.records.follow import refresh_beside
from service.settings import Settings
from service.storage import Storage
from service.units.store import Units
from service.uploads.receive import upload
from service.work.helper import Helper
from service.work.kinds import LEASE, OUTLOOKS
from service.work.loop import Worker, work_next
from tests.databases import one_engine
from tests.service.made_records import step, way
from tests.service.made_sessions import session_bytes, session_id
from tests.serving import http_client

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
UNIT = "BA-017"


def fill(storage: Storage, months: tuple[int, ...] = (1, 2, 3, 4)) -> None:
    for month in months:
        upload(storage, content_of(month), "a.json", NOW, is_dated_later=True)


def content_of(month: int) -> bytes:
    return session_bytes(seed=month, month=month, a3_moved=10.0 * month)


def known(storage: Storage) -> dict[str, Any]:
    """The outlook and the open flags of the unit."""
    with storage.database.reading() as store:
        outlook, flags = Outlooks(store).of_unit(UNIT), Flags(store).open_of(Units(store).key(UNIT))
    return {"outlook": outlook, "flags": [(flag.key, flag.summary) for flag in flags]}


def waiting(storage: Storage) -> tuple[str, ...]:
    with storage.database.reading() as store:
        return WorkQueue(store, WorkKind.OUTLOOK).waiting(NOW, 10)


@pytest.fixture
def helper(settings: Settings) -> Iterator[Helper]:
    """A process that makes what is asked for."""
    started = Helper(settings)
    yield started
    started.end()


def test_it_is_what_it_would_be_within_the_upload(storage: Storage) -> None:
    fill(storage)
    assert (known(storage)["outlook"], waiting(storage)) == (None, (UNIT,))
    refresh_beside(storage, UNIT, NOW)
    beside = known(storage)
    fill(storage, (5,))
    withdraw_session(storage, way(storage), session_id(content_of(5)), step())
    within = known(storage)
    assert (beside["outlook"].due is not None, beside) == (True, within)
    assert waiting(storage) == ()


def test_what_changed_meanwhile_is_looked_at_again(storage: Storage) -> None:
    fill(storage, (1, 2))
    with storage.database.reading() as store:
        before = WorkQueue(store, WorkKind.OUTLOOK).get(UNIT)
    fill(storage, (3,))
    assert before is not None
    with storage.database.writing() as store:
        assert not WorkQueue(store, WorkKind.OUTLOOK).holds(UNIT, before.ticket)


def test_one_process_claims_it_at_a_time(storage: Storage) -> None:
    fill(storage, (1, 2))
    for got in (1, None):
        with storage.database.writing() as store:
            assert WorkQueue(store, WorkKind.OUTLOOK).claim(UNIT, NOW, NOW + LEASE) == got
    with storage.database.writing() as store:
        assert WorkQueue(store, WorkKind.OUTLOOK).claim(UNIT, NOW + LEASE, NOW + 2 * LEASE)


@one_engine
def test_a_process_of_its_own_works_it_out(settings: Settings, storage: Storage, helper: Helper) -> None:
    fill(storage, (1, 2))
    own = Worker(settings, storage, lambda: NOW, Metrics(), Bell())
    assert work_next(own, helper.make, Event(), OUTLOOKS)
    assert known(storage)["outlook"] is not None
    assert not work_next(own, helper.make, Event(), OUTLOOKS)


@one_engine
@pytest.mark.usefixtures("patient_readers")
def test_whoever_asks_whether_a_unit_may_be_used_waits_for_its_dates(settings: Settings) -> None:
    with http_client(create_app(settings.model_copy(update={"diagnosis_workers": 1}), lambda: NOW)) as client:
        for month in (9, 10):
            client.post("/api/v1/sessions", content=session_bytes(seed=month, month=month)).raise_for_status()
        answer = client.get(f"/api/v1/units/{UNIT}/usable").json()
    assert (answer["usable"], answer["next_calibration"] is not None) == (True, True)


@one_engine
def test_until_its_dates_are_known_it_may_not_be_used_and_says_why(settings: Settings, storage: Storage) -> None:
    fill(storage, (9, 10))
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.OUTLOOK).claim(UNIT, NOW, NOW + LEASE)
    worked = settings.model_copy(update={"diagnosis_workers": 1})
    with http_client(create_app(worked, lambda: NOW)) as client:
        page = client.get(f"/units/{UNIT}", headers={"Accept": "text/html"}).text
        answer = usable_now(storage)
    assert "being computed" in page
    assert 'http-equiv="refresh"' in page
    assert (answer.usable, answer.reasons) == (False, (DATES_PENDING,))


def usable_now(storage: Storage) -> Usable:
    with storage.database.reading() as store:
        return usable(store, UNIT, NOW)
