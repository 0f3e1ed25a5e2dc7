"""Work that no process outlives is given up after some tries, said so, and goes on when there is something new."""

import os
import signal
from collections.abc import Iterator
from datetime import UTC, datetime
from threading import Event

import pytest

from service.groups.records import Level
from service.groups.store import Groups
from service.groups.words import FAILED
from service.jobs.changes import retry_failed
from service.jobs.store import Failures
from service.judging.usable_reading import usable_unit as usable
from service.kit.bell import Bell
from service.kit.failure import AT_FAULT, unit_failed, with_last_try
from service.kit.guard import Failure
from service.kit.metrics import Metrics
from service.models.records import AcceptedFinding, ModelRevision, Progress, Scope
from service.models.store import Models, Recomputations
from service.models.words import GIVEN_UP, left_in_words
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.refresh_group import current
from service.sessions.store import Sessions
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from service.work.helper import Helper, KeepGoing
from service.work.kinds import GROUPS, MODELS, MOST_ATTEMPTS, OUTLOOKS, Kind
from service.work.loop import Worker, work_next
from tests.databases import one_engine
from tests.service.grouped import GROUP
from tests.service.made_sessions import session_id

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
UNIT = "BA-017"


@pytest.fixture
def helper(settings: Settings) -> Iterator[Helper]:
    """A process that makes what is asked for."""
    started = Helper(settings)
    yield started
    started.end()


@pytest.fixture
def two(storage: Storage) -> Storage:
    """A store of a unit with two sessions, whose outlook and groups are asked for."""
    for content in GROUP[:2]:
        upload(storage, content, "a.json", NOW, is_dated_later=True)
    return storage


def killed(helper: Helper, now: datetime, still: KeepGoing) -> Failure | None:
    """The process dies at its work, as when the machine has no memory left."""
    helper.start()
    process = helper._process
    assert process is not None
    assert process.pid is not None
    os.kill(process.pid, signal.SIGKILL)
    return helper.make(OUTLOOKS, UNIT, now, still)


def tries(own: Worker, helper: Helper, kind: Kind) -> int:
    """Number of times that the work is begun until nothing of it waits."""
    count = 0
    while work_next(own, lambda _, __, now, still: killed(helper, now, still), Event(), kind):
        count += 1
    return count


def diagnosing(settings: Settings, storage: Storage) -> Worker:
    return Worker(settings, storage, lambda: NOW, Metrics(), Bell())


@one_engine
def test_an_outlook_is_given_up_until_its_unit_s_history_changes(
    settings: Settings, two: Storage, helper: Helper
) -> None:
    assert tries(diagnosing(settings, two), helper, OUTLOOKS) == MOST_ATTEMPTS + 1
    with two.database.reading() as store:
        assert not WorkQueue(store, WorkKind.OUTLOOK).is_pending(UNIT)
        assert unit_failed("The process died at the outlook of BA-017.") in usable(store, UNIT, NOW).reservations
    upload(two, GROUP[2], "a.json", NOW, is_dated_later=True)
    with two.database.reading() as store:
        assert WorkQueue(store, WorkKind.OUTLOOK).waiting(NOW, 10) == (UNIT,)


@one_engine
def test_another_start_tries_an_outlook_again(settings: Settings, two: Storage, helper: Helper) -> None:
    tries(diagnosing(settings, two), helper, OUTLOOKS)
    with two.database.writing() as store:
        assert WorkQueue(store, WorkKind.OUTLOOK).waiting(NOW, 10) == ()
        Failures(store).try_again()
        assert WorkQueue(store, WorkKind.OUTLOOK).waiting(NOW, 10) == (UNIT,)


@one_engine
def test_a_group_is_given_up_with_these_sessions_and_says_so(settings: Settings, two: Storage, helper: Helper) -> None:
    assert tries(diagnosing(settings, two), helper, GROUPS) == 3 * (MOST_ATTEMPTS + 2)
    with two.database.reading() as store:
        group = Groups(store).find(Level.UNIT, UNIT)
        answer = current(store, group)
    assert answer is not None
    died = "The process died at the outlook of BA-017."
    assert (answer.summary, answer.document) == (with_last_try(FAILED, died), None)
    upload(two, GROUP[2], "a.json", NOW, is_dated_later=True)
    with two.database.reading() as store:
        assert current(store, group) is None


@one_engine
def test_sessions_keep_what_they_had_where_no_process_outlives_their_model(
    settings: Settings, two: Storage, helper: Helper
) -> None:
    with two.database.writing() as store:
        revision = Models(store).add(accepted())
        Recomputations(store).ask(revision.id, Scope.UNIT, UNIT, NOW)
    assert tries(diagnosing(settings, two), helper, MODELS) == MOST_ATTEMPTS + 1
    with two.database.reading() as store:
        given_up = Recomputations(store).of(revision.id)
        assert [one.state for one in given_up] == [Progress.GIVEN_UP]
        assert Sessions(store).get(session_id(GROUP[0])).revision == 0
    assert left_in_words(given_up[0]) == GIVEN_UP
    assert retry_failed(two, NOW, "A. Weber") == 1
    assert work_next(diagnosing(settings, two), helper.make, Event(), MODELS)
    with two.database.reading() as store:
        assert [one.state for one in Recomputations(store).of(revision.id)] == [Progress.DONE]


def accepted() -> ModelRevision:
    evidence = AcceptedFinding(1e-4, 7.0, (1e-8,), (1e-9,), ("(m/s²)⁻²",), {}, (), "", None)
    return ModelRevision(
        0, Scope.UNIT, UNIT, "cubic-nonlinearity", ("A2",), session_id(GROUP[0]), evidence, "K. Ito", "", NOW
    )


@one_engine
def test_a_session_at_fault_is_not_blamed_on_its_group(storage: Storage, two: Storage) -> None:
    with two.database.writing() as store:
        group = Groups(store).find(Level.UNIT, UNIT)
        for _ in range(2):
            WorkQueue(store, WorkKind.GROUP).claim(group.place, NOW, NOW)
        WorkQueue(store, WorkKind.GROUP).reset_attempts(group.place)
        assert WorkQueue(store, WorkKind.GROUP).claim(group.place, NOW, NOW) == 1


@one_engine
def test_what_fails_with_a_word_is_put_off_and_never_given_up(settings: Settings, two: Storage) -> None:
    def fails(kind: Kind, one: str, now: datetime, still: KeepGoing) -> Failure | None:
        return Failure("ValueError", "no")

    own = diagnosing(settings, two)
    assert work_next(own, fails, Event(), OUTLOOKS)
    assert not work_next(own, fails, Event(), OUTLOOKS)


@one_engine
def test_what_the_program_fails_at_is_given_up_too(settings: Settings, two: Storage) -> None:
    def fails(kind: Kind, one: str, now: datetime, still: KeepGoing) -> Failure | None:
        return Failure("KeyError", AT_FAULT, is_foreseen=False)

    begun = 0
    while work_next(diagnosing(settings, two), fails, Event(), OUTLOOKS):
        begun += 1
    assert begun == MOST_ATTEMPTS + 1
