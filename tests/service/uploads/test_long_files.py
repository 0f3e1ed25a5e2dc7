"""A long file that was received whole becomes a session once, whatever interrupts it; cancelled it leaves nothing."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from threading import Event

import pytest

from service.errors import AwayError, BusyError, ConflictError, NotFoundError
from service.jobs import changes as ask_job
from service.jobs.changes import cancel_job
from service.jobs.records import Job, JobState
from service.jobs.store import Jobs
from service.kit import limits
from service.kit.bell import Bell
from service.kit.metrics import Metrics
from service.kit.person import EVERYBODY
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.reception import Reception
from service.sessions.records import SessionQuery
from service.sessions.sent import Replaced, SentFile
from service.sessions.store import Sessions
from service.settings import Settings
from service.storage import Files, Storage
from service.storage.waiting import FOLDER, JOB_DELAY
from service.uploads import take_in as flow
from service.uploads.take_in import ask_upload, sweep_waiting, take_in
from service.work.kinds import MOST_ATTEMPTS_OF_FILE, UPLOADS
from service.work.loop import Worker, upload_maker, work_next
from tests import builders
from tests.databases import one_engine
from tests.estimator.test_reading_csv import csv_of
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
SESSION = SentFile("a.json", session_bytes())
LOG = SentFile("log.csv", csv_of(builders.raw_log(6, orientations=24, still=100, moving=20, labelled=True)))


class Killed(BaseException):
    """The process ends here."""


def kill(*_: object) -> None:
    raise Killed


def reception(storage: Storage) -> Reception:
    return Reception(storage, 2.0, Metrics(), lambda: None)


def asked(storage: Storage, file: SentFile = SESSION, place: str = "one") -> Job:
    return ask_upload(storage, file, EVERYBODY, place, NOW)


def read(storage: Storage, id: int) -> Job:
    with storage.database.reading() as store:
        return Jobs(store).get(id)


def sessions(storage: Storage) -> list[str]:
    with storage.database.reading() as store:
        return [one.id for one in Sessions(store).wanted(SessionQuery(limit=10))]


def waiting(storage: Storage) -> list[Path]:
    return list((storage.files.folder / FOLDER).glob("*"))


def uploads(storage: Storage, settings: Settings) -> Callable[[], bool]:
    """Function that works on the next upload; it returns whether there was one."""
    own = Worker(settings, storage, lambda: NOW, Metrics(), Bell())
    return lambda: work_next(own, upload_maker(own), Event(), UPLOADS)


@pytest.fixture
def few_cells() -> Iterator[None]:
    """The log is too long to be held."""
    usual = limits.in_force()
    limits.use(replace(usual, cells=1000))
    yield
    limits.use(usual)


def test_it_is_stored_as_any_upload_and_leaves_no_other_file(storage: Storage) -> None:
    job = asked(storage)
    take_in(reception(storage), job.id, NOW)
    ended = read(storage, job.id)
    assert (ended.state, [ended.session], ended.done) == (JobState.DONE, sessions(storage), ended.total)
    assert waiting(storage) == []


def test_one_that_cannot_be_used_ends_with_one_refusal(storage: Storage) -> None:
    job = asked(storage, SentFile("a.json", b"{}"))
    take_in(reception(storage), job.id, NOW)
    take_in(reception(storage), job.id, NOW)
    ended = read(storage, job.id)
    assert (ended.state, ended.refusal, waiting(storage)) == (JobState.FAILED, 1, [])


def test_the_same_sent_twice_is_one_job(storage: Storage) -> None:
    assert asked(storage).id == asked(storage, place="two").id
    assert [path.name for path in waiting(storage)] == ["one"]
    assert asked(storage, SentFile("a.json", session_bytes(), is_check=True), "three").id == 2


STEPS = {
    "before its bytes are kept": (Files, "keep"),
    "after its bytes are kept": (flow._JobHooks, "stored"),
    "after it is stored": (flow, "drop_waiting"),
}


@pytest.mark.parametrize("step", STEPS)
def test_a_process_that_is_killed_leaves_what_another_one_ends(
    storage: Storage, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    job = asked(storage)
    with monkeypatch.context() as patch:
        patch.setattr(*STEPS[step], kill)
        with pytest.raises(Killed):
            take_in(reception(storage), job.id, NOW)
    take_in(reception(storage), job.id, NOW)
    assert read(storage, job.id).state is JobState.DONE
    assert (len(sessions(storage)), waiting(storage)) == (1, [])


def test_cancelled_while_it_is_read_it_leaves_nothing(storage: Storage, few_cells: None) -> None:
    job = asked(storage, LOG)

    def cancel() -> None:
        if read(storage, job.id).is_open:
            cancel_job(storage, job.id, EVERYBODY, "K. Ito", NOW)

    take_in(reception(storage), job.id, NOW, cancel)
    assert read(storage, job.id).state is JobState.CANCELLED
    assert (sessions(storage), waiting(storage), list(storage.files.folder.glob("??/*"))) == ([], [], [])


def test_once_it_is_being_stored_nobody_cancels_it(storage: Storage) -> None:
    job = asked(storage)
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.UPLOAD).claim(str(job.id), NOW, NOW)
        assert Jobs(store).begin_storing(job.id)
    with pytest.raises(ConflictError, match="being stored"):
        cancel_job(storage, job.id, EVERYBODY, "K. Ito", NOW)


@one_engine
def test_whoever_waits_reads_how_far_it_is(storage: Storage, few_cells: None) -> None:
    job, seen = asked(storage, LOG), []
    take_in(reception(storage), job.id, NOW, lambda: seen.append(read(storage, job.id).done))
    with storage.database.reading() as store:
        assert Jobs(store).get(job.id).done == job.total
    assert seen, "nothing was told while it was read"


@one_engine
def test_what_passes_is_tried_again_after_a_minute_and_says_why(
    storage: Storage, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    job, work = asked(storage), uploads(storage, settings)

    def away(*_: object) -> None:
        raise AwayError("The database does not answer.")

    with monkeypatch.context() as patch:
        patch.setattr(Files, "keep", away)
        assert work()
    assert (read(storage, job.id).held_up, work()) == ("The database does not answer.", False)
    with storage.database.reading() as store:
        assert WorkQueue(store, WorkKind.UPLOAD).waiting(NOW + timedelta(minutes=1), 10) == (str(job.id),)


@one_engine
def test_one_at_which_the_program_fails_is_given_up(
    storage: Storage, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise KeyError

    job, work = asked(storage), uploads(storage, settings)
    with monkeypatch.context() as patch:
        patch.setattr(Files, "keep", fails)
        assert [work() for _ in range(MOST_ATTEMPTS_OF_FILE + 2)] == [True] * (MOST_ATTEMPTS_OF_FILE + 1) + [False]
    assert (read(storage, job.id).state, waiting(storage)) == (JobState.FAILED, [])


@one_engine
def test_a_file_that_is_gone_or_changed_is_told(storage: Storage) -> None:
    job = asked(storage)
    waiting(storage)[0].write_bytes(b"{}")
    take_in(reception(storage), job.id, NOW)
    ended = read(storage, job.id)
    assert (ended.state, "upload it again" in ended.failures[0].reason) == (JobState.FAILED, True)


@one_engine
def test_what_no_job_waits_for_is_swept_after_an_hour(storage: Storage) -> None:
    asked(storage)
    lost = storage.files.folder / FOLDER / "lost"
    lost.write_bytes(b"1")
    later = datetime.now(UTC) + JOB_DELAY
    for now in (later - timedelta(minutes=1), later + timedelta(minutes=1)):
        sweep_waiting(storage, now)
        assert lost.exists() == (now < later)
    assert [path.name for path in waiting(storage)] == ["one"]


@one_engine
def test_what_it_would_replace_must_be_there(storage: Storage) -> None:
    with pytest.raises(NotFoundError):
        asked(storage, SentFile("a.json", session_bytes(), replaces=Replaced("none", "K. Ito", "wrong")))
    assert waiting(storage) == []


@one_engine
def test_too_many_are_asked_to_come_again_and_leave_nothing(storage: Storage, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ask_job, "MOST_OPEN", 0)
    with pytest.raises(BusyError):
        asked(storage)
    assert waiting(storage) == []


@pytest.mark.parametrize("ended", ["give_back", "put_off", "claim"])
def test_a_job_whose_storing_ended_without_a_session_can_be_cancelled(storage: Storage, ended: str) -> None:
    job = asked(storage)
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.UPLOAD).claim(str(job.id), NOW, NOW)
        Jobs(store).begin_storing(job.id)
    with pytest.raises(ConflictError):
        cancel_job(storage, job.id, EVERYBODY, "K. Ito", NOW)
    later = NOW + timedelta(minutes=5)
    with storage.database.writing() as store:
        queue = WorkQueue(store, WorkKind.UPLOAD)
        if ended == "give_back":
            queue.give_back(str(job.id), NOW)
        elif ended == "put_off":
            queue.put_off(str(job.id), later)
        else:
            queue.claim(str(job.id), later, later)
            Jobs(store).begin(job.id, later)
    cancel_job(storage, job.id, EVERYBODY, "K. Ito", NOW)
    assert read(storage, job.id).state is JobState.CANCELLED
