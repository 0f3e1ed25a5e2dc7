"""Diagnoses are made by processes beside the requests: each once, and none is lost when a process dies."""

import os
import signal
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from threading import Event, Thread

import pytest

from service.app import create_app
from service.background.bell import Bell
from service.background.diagnose_waiting import (
    CLAIM,
    EXTEND,
    MOST_ATTEMPTS,
    PUT_OFF,
    Diagnosing,
    ask_for_missing,
    diagnose_next,
)
from service.background.helper import DIED, Helper, Still
from service.background.read_diagnosis import Reader
from service.errors import AwayError
from service.flows.guard import Failure
from service.flows.receive import upload
from service.metrics import Metrics
from service.records.diagnosis import DiagnosisState
from service.records.pending import Claim
from service.settings import Settings
from service.storage import Storage
from tests.databases import one_engine
from tests.service.sessions import session_bytes
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
def own(settings: Settings, storage: Storage) -> Diagnosing:
    """What makes diagnoses beside the requests."""
    return Diagnosing(settings, storage, Clock(), Metrics(), Bell())


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
        made = store.diagnoses.summary(id)
    return None if made is None else made.state


def waiting(storage: Storage, now: datetime = LATER) -> tuple[str, ...]:
    with storage.database.reading() as store:
        return store.pending.waiting(now, 10)


def test_a_process_of_its_own_makes_what_was_asked_for(own: Diagnosing, helper: Helper) -> None:
    id = stored(own.storage)
    assert diagnose_next(own, helper, Event())
    assert (state_of(own.storage, id), waiting(own.storage)) == (DiagnosisState.NOTHING, ())
    assert not diagnose_next(own, helper, Event())


def test_of_several_that_claim_one_at_once_only_one_gets_it(storage: Storage) -> None:
    id, got = stored(storage), []

    def claim(who: str) -> None:
        with storage.database.writing() as store:
            got.append(store.pending.claim(Claim(id, who, NOW + CLAIM), NOW))

    threads = [Thread(target=claim, args=(str(k),)) for k in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(got, key=str) == [1, None, None, None, None]


def test_a_claim_that_nobody_extends_runs_out(storage: Storage) -> None:
    id = stored(storage)
    claim = Claim(id, "a", NOW + CLAIM)
    with storage.database.writing() as store:
        store.pending.claim(claim, NOW)
    assert (waiting(storage, NOW + CLAIM / 2), waiting(storage, NOW + CLAIM)) == ((), (id,))
    with storage.database.writing() as store:
        store.pending.extend(Claim(id, "a", NOW + 2 * CLAIM))
        store.pending.extend(Claim(id, "somebody else", LATER))
    assert (waiting(storage, NOW + CLAIM), waiting(storage, NOW + 2 * CLAIM)) == ((), (id,))


@one_engine
def test_a_process_that_is_killed_at_its_work_costs_nothing(own: Diagnosing, helper: Helper) -> None:
    id = stored(own.storage)
    helper.start()
    assert helper._process is not None
    pid = helper._process.pid
    os.kill(pid, signal.SIGSTOP)

    def killed() -> bool:
        os.kill(pid, signal.SIGKILL)
        return True

    assert helper.diagnose(id, NOW, killed) == Failure(DIED, f"The process died at the diagnosis of {id}.", False)
    assert waiting(own.storage) == (id,)
    assert diagnose_next(own, helper, Event())
    assert state_of(own.storage, id) is DiagnosisState.NOTHING


@one_engine
def test_an_answer_that_nobody_took_is_never_that_of_the_next_job(own: Diagnosing, helper: Helper) -> None:
    lost, sound = stored(own.storage, 1), stored(own.storage, 2)
    with own.storage.database.reading() as store:
        own.storage.files.path(store.sessions.get(lost).sha256).unlink()
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
        helper.diagnose(lost, NOW, breaks)
    assert helper.diagnose(sound, NOW, lambda: True) is None
    assert state_of(own.storage, sound) is DiagnosisState.NOTHING


@one_engine
def test_what_no_process_outlives_is_given_up_and_says_so(own: Diagnosing, helper: Helper) -> None:
    id = stored(own.storage)
    for _ in range(MOST_ATTEMPTS):
        claim = Claim(id, "a process that dies", NOW)
        with own.storage.database.writing() as store:
            store.pending.claim(claim, NOW)
            store.pending.give_back(claim)
    assert diagnose_next(own, helper, Event())
    assert (state_of(own.storage, id), waiting(own.storage)) == (DiagnosisState.FAILED, ())


@one_engine
def test_a_service_that_stops_gives_back_what_it_is_at(own: Diagnosing, helper: Helper) -> None:
    id, stop = stored(own.storage), Event()
    stop.set()
    diagnose_next(own, helper, stop)
    assert waiting(own.storage, NOW) == (id,)


@one_engine
def test_a_file_that_is_lost_is_put_off_and_tried_again_by_whoever_reads(own: Diagnosing, helper: Helper) -> None:
    id = stored(own.storage)
    with own.storage.database.reading() as store:
        file = own.storage.files.path(store.sessions.get(id).sha256)
    file.rename(file.with_suffix(".away"))
    assert diagnose_next(own, helper, Event())
    assert (waiting(own.storage, NOW), waiting(own.storage, NOW + PUT_OFF)) == ((), (id,))
    file.with_suffix(".away").rename(file)
    reader = Reader(own.storage, own.clock, own.bell, own.metrics, 2.0, workers=1)
    made = reader.read(id)
    assert made is not None
    assert made.state is DiagnosisState.NOTHING


def test_what_changed_while_a_diagnosis_was_made_is_looked_at_again(storage: Storage) -> None:
    later = upload(storage, session_bytes(seed=2, month=2), "b.json", NOW).id
    with storage.database.reading() as store:
        before = store.pending.of(later)
    upload(storage, session_bytes(seed=1, month=1), "a.json", NOW)
    assert before is not None
    with storage.database.writing() as store:
        assert not store.pending.settle(later, before.ticket)
    assert later in waiting(storage)


def test_a_starting_service_asks_for_what_is_missing(storage: Storage) -> None:
    id = stored(storage)
    with storage.database.writing() as store:
        now = store.pending.of(id)
        assert store.pending.settle(id, now and now.ticket)
    assert waiting(storage) == ()
    ask_for_missing(storage, lambda: NOW, Metrics(), Bell(), Event())
    assert waiting(storage) == (id,)


@one_engine
def test_what_somebody_waits_for_comes_first(own: Diagnosing, helper: Helper) -> None:
    first, second = stored(own.storage, 1), stored(own.storage, 2)
    own.bell.hurry(second)
    diagnose_next(own, helper, Event())
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
def test_whoever_is_long_at_it_says_so(own: Diagnosing, monkeypatch: pytest.MonkeyPatch) -> None:
    id = stored(own.storage)

    class Slow(Helper):
        def diagnose(self, id: str, now: datetime, still: Still) -> None:
            own.clock.now = NOW + 2 * EXTEND  # type: ignore[attr-defined]
            assert still()
            assert waiting(own.storage, NOW + CLAIM) == ()

    assert diagnose_next(own, Slow(own.settings), Event())
    assert waiting(own.storage, NOW + 2 * EXTEND + CLAIM) == (id,)
