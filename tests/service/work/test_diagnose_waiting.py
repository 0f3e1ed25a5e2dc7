"""Diagnoses are made by processes beside the requests: each once, and none is lost when a process dies."""

import os
import signal
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from threading import Event, Thread

import pytest

from service.app import create_app
from service.diagnosis.store import Diagnoses
from service.errors import AwayError
from service.kit.bell import Bell
from service.kit.guard import Failure
from service.kit.metrics import Metrics
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.sessions.records import DiagnosisState
from service.sessions.store import Sessions
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from service.work.helper import DIED, Helper, KeepGoing
from service.work.kinds import DIAGNOSES, LEASE, MOST_ATTEMPTS, PUT_OFF, Kind
from service.work.loop import LEASE_EXTENSION, Worker, work_next
from service.work.readers import Reader
from service.work.watch import ask_for_missing
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.serving import http_client

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
LATER = NOW + timedelta(hours=1)


class Clock:
    """Stands still until it is moved."""

    def __init__(self) -> None:
        self.now = NOW

    def __call__(self) -> datetime:
        return self.now


@pytest.fixture
def own(settings: Settings, storage: Storage) -> Worker:
    """Worker that makes diagnoses beside the requests."""
    return Worker(settings, storage, Clock(), Metrics(), Bell())


@pytest.fixture
def helper(settings: Settings) -> Iterator[Helper]:
    """A process that makes diagnoses."""
    started = Helper(settings)
    yield started
    started.end()


def stored(storage: Storage, seed: int = 1) -> str:
    return upload(storage, session_bytes(seed=seed), "a.json", NOW).id


def state_of(storage: Storage, id: str) -> DiagnosisState | None:
    with storage.database.reading() as store:
        made = Diagnoses(store).summary(id)
    return None if made is None else made.state


def waiting(storage: Storage, now: datetime = LATER) -> tuple[str, ...]:
    with storage.database.reading() as store:
        return WorkQueue(store, WorkKind.DIAGNOSIS).waiting(now, 10)


def test_a_process_of_its_own_makes_what_was_asked_for(own: Worker, helper: Helper) -> None:
    id = stored(own.storage)
    assert work_next(own, helper.make, Event(), DIAGNOSES)
    assert (state_of(own.storage, id), waiting(own.storage)) == (DiagnosisState.NOTHING, ())
    assert not work_next(own, helper.make, Event(), DIAGNOSES)


def test_of_several_that_claim_one_at_once_only_one_gets_it(storage: Storage) -> None:
    id, got = stored(storage), []

    def claim() -> None:
        with storage.database.writing() as store:
            got.append(WorkQueue(store, WorkKind.DIAGNOSIS).claim(id, NOW, NOW + LEASE))

    threads = [Thread(target=claim) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(got, key=str) == [1, None, None, None, None]


def test_a_claim_that_nobody_extends_runs_out(storage: Storage) -> None:
    id = stored(storage)
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.DIAGNOSIS).claim(id, NOW, NOW + LEASE)
    assert (waiting(storage, NOW + LEASE / 2), waiting(storage, NOW + LEASE)) == ((), (id,))
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.DIAGNOSIS).extend(id, NOW + 2 * LEASE)
    assert (waiting(storage, NOW + LEASE), waiting(storage, NOW + 2 * LEASE)) == ((), (id,))


@one_engine
def test_a_process_that_is_killed_at_its_work_costs_nothing(own: Worker, helper: Helper) -> None:
    id = stored(own.storage)
    helper.start()
    assert helper._process is not None
    pid = helper._process.pid
    os.kill(pid, signal.SIGSTOP)

    def killed() -> bool:
        os.kill(pid, signal.SIGKILL)
        return True

    assert helper.make(DIAGNOSES, id, NOW, killed) == Failure(
        DIED, f"The process died at the diagnosis of {id}.", False
    )
    assert waiting(own.storage) == (id,)
    assert work_next(own, helper.make, Event(), DIAGNOSES)
    assert state_of(own.storage, id) is DiagnosisState.NOTHING


@one_engine
def test_an_answer_that_nobody_took_is_never_that_of_the_next_job(own: Worker, helper: Helper) -> None:
    lost, sound = stored(own.storage, 1), stored(own.storage, 2)
    with own.storage.database.reading() as store:
        own.storage.files.path(Sessions(store).get(lost).sha256).unlink()
    helper.start()
    assert helper._process is not None
    pid, asked = helper._process.pid, iter([True])
    os.kill(pid, signal.SIGSTOP)  # it has not answered yet when somebody looks whether to go on

    def breaks() -> bool:
        if not next(asked, False):
            os.kill(pid, signal.SIGCONT)
            raise AwayError("The database does not answer.")
        return True

    with pytest.raises(AwayError):
        helper.make(DIAGNOSES, lost, NOW, breaks)
    assert helper.make(DIAGNOSES, sound, NOW, lambda: True) is None
    assert state_of(own.storage, sound) is DiagnosisState.NOTHING


@one_engine
def test_what_no_process_outlives_is_given_up_and_says_so(own: Worker, helper: Helper) -> None:
    id = stored(own.storage)
    for _ in range(MOST_ATTEMPTS):
        with own.storage.database.writing() as store:
            WorkQueue(store, WorkKind.DIAGNOSIS).claim(id, NOW, NOW)
            WorkQueue(store, WorkKind.DIAGNOSIS).give_back(id, NOW)
    assert work_next(own, helper.make, Event(), DIAGNOSES)
    assert (state_of(own.storage, id), waiting(own.storage)) == (DiagnosisState.FAILED, ())


@one_engine
def test_a_service_that_stops_gives_back_what_it_is_at(own: Worker, helper: Helper) -> None:
    id, stop = stored(own.storage), Event()
    stop.set()
    work_next(own, helper.make, stop, DIAGNOSES)
    assert waiting(own.storage, NOW) == (id,)


@one_engine
def test_a_file_that_is_lost_is_put_off_and_tried_again_by_whoever_reads(own: Worker, helper: Helper) -> None:
    id = stored(own.storage)
    with own.storage.database.reading() as store:
        file = own.storage.files.path(Sessions(store).get(id).sha256)
    file.rename(file.with_suffix(".away"))
    assert work_next(own, helper.make, Event(), DIAGNOSES)
    assert (waiting(own.storage, NOW), waiting(own.storage, NOW + PUT_OFF)) == ((), (id,))
    file.with_suffix(".away").rename(file)
    reader = Reader(own.storage, own.clock, own.bell, own.metrics, 2.0, workers=1)
    made = reader.read(id)
    assert made is not None
    assert made.state is DiagnosisState.NOTHING


def test_what_changed_while_a_diagnosis_was_made_is_looked_at_again(storage: Storage) -> None:
    later = upload(storage, session_bytes(seed=2, month=2), "b.json", NOW).id
    with storage.database.reading() as store:
        before = WorkQueue(store, WorkKind.DIAGNOSIS).get(later)
    upload(storage, session_bytes(seed=1, month=1), "a.json", NOW)
    assert before is not None
    with storage.database.writing() as store:
        assert not WorkQueue(store, WorkKind.DIAGNOSIS).settle(later, before.ticket)
    assert later in waiting(storage)


def test_a_starting_service_asks_for_what_is_missing(storage: Storage) -> None:
    id = stored(storage)
    with storage.database.writing() as store:
        now = WorkQueue(store, WorkKind.DIAGNOSIS).get(id)
        assert WorkQueue(store, WorkKind.DIAGNOSIS).settle(id, now and now.ticket)
    assert waiting(storage) == ()
    ask_for_missing(storage, lambda: NOW, Metrics(), Bell(), Event())
    assert waiting(storage) == (id,)


@one_engine
def test_what_somebody_waits_for_comes_first(own: Worker, helper: Helper) -> None:
    first, second = stored(own.storage, 1), stored(own.storage, 2)
    with own.storage.database.writing() as store:
        WorkQueue(store, WorkKind.DIAGNOSIS).hurry(second)
    work_next(own, helper.make, Event(), DIAGNOSES)
    assert (waiting(own.storage), state_of(own.storage, second)) == ((first,), DiagnosisState.NOTHING)


@pytest.mark.usefixtures("patient_readers")
def test_two_services_on_one_database_make_each_diagnosis_once(settings: Settings, storage: Storage) -> None:
    worked = settings.model_copy(update={"diagnosis_workers": 1})
    ids = [stored(storage, seed) for seed in range(4)]
    with http_client(create_app(worked)) as one, http_client(create_app(worked)) as other:
        for id in ids:
            for client in (one, other):
                assert client.get(f"/api/v1/sessions/{id}/diagnosis").status_code == 200
        lines = one.get("/api/v1/audit", params={"limit": 100}).json()["lines"]
    assert sorted(line["subject"] for line in lines if line["action"] == "diagnose") == sorted(ids)


@one_engine
def test_whoever_is_long_at_it_says_so(own: Worker, monkeypatch: pytest.MonkeyPatch) -> None:
    id = stored(own.storage)

    def slow(kind: Kind, id: str, now: datetime, still: KeepGoing) -> None:
        own.clock.now = NOW + 2 * LEASE_EXTENSION  # type: ignore[attr-defined]
        assert still()
        assert waiting(own.storage, NOW + LEASE) == ()

    assert work_next(own, slow, Event(), DIAGNOSES)
    assert waiting(own.storage, NOW + 2 * LEASE_EXTENSION + LEASE) == (id,)
