"""Long work is claimed once, goes on where it was left, stops between two pieces, and lists what could not be done."""

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from threading import Event

import pytest

from service.errors import ConflictError
from service.jobs.changes import add_model_job, ask_job, cancel_job, drop_expired, file_of
from service.jobs.records import KEPT, Job, JobKind, JobState, NewJob, RecalibrationPiece
from service.jobs.store import Jobs
from service.kit.bell import Bell
from service.kit.failure import AT_FAULT
from service.kit.guard import Failure
from service.kit.metrics import Metrics
from service.kit.person import EVERYBODY
from service.models.records import ModelRevision, Progress, Task
from service.models.store import Models, Recomputations
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.recalibrate import recompute
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from service.work.helper import Helper, KeepGoing
from service.work.kinds import JOBS, LEASE, MOST_ATTEMPTS, Kind, work_piece
from service.work.loop import Worker, work_next
from tests.conftest import Filled, SettingsFilled
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
from tests.databases import one_engine
from tests.service.grouped import GROUP
from tests.service.made_sessions import session_bytes
from tests.service.work.test_given_up import accepted
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
AGAIN = NewJob(JobKind.RECALIBRATION, "K. Ito")
REPORT = NewJob(JobKind.REPORT, "K. Ito", form="xlsx", language="en")


def three_units(settings: Settings) -> None:
    """Stores three units of one session each."""
    with stores(settings) as storage:
        for unit in ("B-1", "B-2", "B-3"):
            upload(storage, session_bytes(unit=unit), "a.json", NOW)


def one_unit(storage: Storage) -> None:
    """Stores a unit with two sessions."""
    for content in GROUP[:2]:
        upload(storage, content, "a.json", NOW)


@pytest.fixture
def settings(settings_filled: SettingsFilled) -> Settings:
    return settings_filled(three_units)


@pytest.fixture
def three(storage: Storage) -> Storage:
    """The stores of three units."""
    return storage


@pytest.fixture
def two_sessions(filled: Filled) -> Storage:
    """The stores of one unit."""
    return filled(one_unit)


def change_model(storage: Storage) -> tuple[ModelRevision, Job]:
    """A revision of the unit's model, with the job that it brings."""
    with storage.database.writing() as store:
        changed = Models(store).add(accepted())
        add_model_job(store, changed, Recomputations(store).ask(changed.id, changed.scope, changed.subject, NOW), NOW)
        return changed, Jobs(store).page(1)[0]


@pytest.fixture
def helper(settings: Settings) -> Iterator[Helper]:
    """A process that does what is asked for."""
    started = Helper(settings)
    yield started
    started.end()


def claim(storage: Storage, id: int, now: datetime = NOW) -> int | None:
    with storage.database.writing() as store:
        return WorkQueue(store, WorkKind.JOB).claim(str(id), now, now + LEASE)


def read(storage: Storage, id: int) -> Job:
    with storage.database.reading() as store:
        return Jobs(store).get(id)


def pieces(storage: Storage, id: int, count: int) -> Job:
    """Does so many pieces of a job, one after another."""
    for _ in range(count):
        assert claim(storage, id) == 1
        work_piece(storage, id, NOW, 2.0)
    return read(storage, id)


def test_one_process_claims_it_at_a_time_and_a_dead_one_s_claim_runs_out(three: Storage) -> None:
    id = ask_job(three, AGAIN, NOW).id
    assert [claim(three, id), claim(three, id), claim(three, id, NOW + LEASE)] == [1, None, 2]


def test_the_same_asked_for_twice_is_one_job(three: Storage) -> None:
    assert ask_job(three, AGAIN, NOW) == ask_job(three, AGAIN, NOW)
    assert ask_job(three, REPORT, NOW).id != ask_job(three, AGAIN, NOW).id


def test_it_goes_on_behind_the_last_whole_piece_until_all_are_done(three: Storage) -> None:
    id = ask_job(three, AGAIN, NOW).id
    assert [pieces(three, id, 1).done, pieces(three, id, 1).done] == [1, 2]
    ended = pieces(three, id, 2)
    assert (ended.state, ended.done, ended.total) == (JobState.DONE, 3, 3)
    assert claim(three, id) is None


def test_a_piece_that_two_were_at_is_counted_once(three: Storage) -> None:
    id = ask_job(three, AGAIN, NOW).id
    claim(three, id)
    before = read(three, id)
    work_piece(three, id, NOW, 2.0)
    with three.database.writing() as store:
        unit = Jobs(store).next_unit(before)
        assert unit is not None
        Jobs(store).advance(before, unit[0], RecalibrationPiece(), NOW)
    assert read(three, id).done == 1


def test_it_is_cancelled_between_two_pieces_and_keeps_what_is_whole(three: Storage) -> None:
    id = ask_job(three, AGAIN, NOW).id
    pieces(three, id, 1)
    assert claim(three, id) == 1
    cancel_job(three, id, EVERYBODY, "A. Silva", NOW)
    work_piece(three, id, NOW, 2.0)
    ended = read(three, id)
    assert (ended.state, ended.done, ended.cancelled_by) == (JobState.CANCELLED, 1, "A. Silva")
    with pytest.raises(ConflictError):
        cancel_job(three, id, EVERYBODY, "A. Silva", NOW)


def test_the_units_of_a_changed_model_are_one_job(two_sessions: Storage) -> None:
    changed, job = change_model(two_sessions)
    with two_sessions.database.reading() as store:
        assert WorkQueue(store, WorkKind.JOB).waiting(NOW, 10) == ()
    recompute(two_sessions, Task(changed.id, "BA-017"), NOW, 2.0)
    recompute(two_sessions, Task(changed.id, "BA-017"), NOW, 2.0)
    ended = read(two_sessions, job.id)
    assert (ended.state, ended.done, ended.total) == (JobState.DONE, 1, 1)


def test_a_changed_model_is_cancelled_for_units_that_nobody_is_at(two_sessions: Storage) -> None:
    changed, job = change_model(two_sessions)
    cancel_job(two_sessions, job.id, EVERYBODY, "A. Silva", NOW)
    with two_sessions.database.reading() as store:
        assert Recomputations(store).waiting(NOW, 10) == ()
        assert [one.state for one in Recomputations(store).of(changed.id)] == [Progress.CANCELLED]


@one_engine
def test_several_jobs_take_turns(three: Storage) -> None:
    ids = [ask_job(three, new, NOW).id for new in (AGAIN, REPORT)]
    claim(three, ids[0])
    with three.database.writing() as store:
        WorkQueue(store, WorkKind.JOB).give_back(str(ids[0]), NOW + timedelta(seconds=1))
        assert WorkQueue(store, WorkKind.JOB).waiting(NOW, 10) == (str(ids[1]), str(ids[0]))


@one_engine
def test_a_process_of_its_own_does_it(settings: Settings, three: Storage, helper: Helper) -> None:
    again, report = ask_job(three, AGAIN, NOW).id, ask_job(three, REPORT, NOW).id
    own = Worker(settings, three, lambda: NOW, Metrics(), Bell())
    while work_next(own, helper.make, Event(), JOBS):
        pass
    assert [read(three, id).state for id in (again, report)] == [JobState.DONE] * 2
    assert file_of(three.files, read(three, report)).startswith(b"PK")
    drop_expired(three, NOW + KEPT)
    with pytest.raises(ConflictError):
        file_of(three.files, read(three, report))


@one_engine
def test_a_unit_at_which_the_program_fails_is_listed_and_the_others_follow(settings: Settings, three: Storage) -> None:
    def fails(kind: Kind, id: str, now: datetime, still: KeepGoing) -> Failure | None:
        return Failure("KeyError", AT_FAULT, is_foreseen=False)

    id = ask_job(three, AGAIN, NOW).id
    own = Worker(settings, three, lambda: NOW, Metrics(), Bell())
    for _ in range(MOST_ATTEMPTS + 1):
        assert work_next(own, fails, Event(), JOBS)
    listed = read(three, id)
    assert (listed.done, [one.subject for one in listed.failures]) == (1, ["B-1"])
    assert pieces(three, id, 3).state is JobState.DONE


@one_engine
def test_a_report_that_was_cancelled_leaves_no_file(three: Storage) -> None:
    job = ask_job(three, REPORT, NOW)
    claim(three, job.id)
    with three.database.writing() as store:
        Jobs(store).cancel(job.id, "A. Silva", NOW)
    work_piece(three, job.id, NOW, 2.0)
    assert not list(three.files.folder.glob("made/*"))
