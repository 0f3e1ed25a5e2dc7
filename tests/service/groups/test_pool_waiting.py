"""Findings of groups are made beside the requests, by one process at a time."""

from collections.abc import Iterator
from datetime import UTC, datetime
from threading import Event

import pytest

from service.groups.records import Group, Level
from service.groups.store import Groups
from service.kit.bell import Bell
from service.kit.metrics import Metrics
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.refresh_group import current, refresh_group
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from service.work.helper import Helper
from service.work.kinds import GROUPS, LEASE
from service.work.loop import Worker, work_next
from service.work.watch import ask_for_outdated
from tests.databases import one_engine
from tests.service.grouped import GROUP

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


@pytest.fixture
def unit(storage: Storage) -> Group:
    """A unit of two sessions, whose groups are asked for."""
    for content in GROUP[:2]:
        upload(storage, content, "a.json", NOW)
    with storage.database.reading() as store:
        return Groups(store).find(Level.UNIT, "BA-017")


@pytest.fixture
def helper(settings: Settings) -> Iterator[Helper]:
    """A process that makes what is asked for."""
    started = Helper(settings)
    yield started
    started.end()


def waiting(storage: Storage, now: datetime = NOW) -> list[Level]:
    with storage.database.reading() as store:
        return [Groups(store).at(place).level for place in WorkQueue(store, WorkKind.GROUP).waiting(now, 10)]


@one_engine
def test_a_process_of_its_own_makes_one_after_another(
    settings: Settings, storage: Storage, unit: Group, helper: Helper
) -> None:
    own = Worker(settings, storage, lambda: NOW, Metrics(), Bell())
    made = [work_next(own, helper.make, Event(), GROUPS) for _ in range(4)]
    assert (made, waiting(storage)) == ([True, True, True, False], [])
    with storage.database.reading() as store:
        answer = current(store, unit)
    assert answer is not None
    assert answer.sessions == 2


def test_one_process_claims_a_group_at_a_time(storage: Storage, unit: Group) -> None:
    for got in (1, None):
        with storage.database.writing() as store:
            assert WorkQueue(store, WorkKind.GROUP).claim(unit.place, NOW, NOW + LEASE) == got
    assert Level.UNIT not in waiting(storage)
    assert Level.UNIT in waiting(storage, NOW + LEASE)


def test_who_asks_while_it_is_made_is_not_settled_with_it(storage: Storage, unit: Group) -> None:
    with storage.database.reading() as store:
        asked = WorkQueue(store, WorkKind.GROUP).tickets(unit.place)
    upload(storage, GROUP[2], "a.json", NOW)
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.GROUP).settle_each(asked)
    assert Level.UNIT in waiting(storage)


def test_groups_without_an_answer_of_now_are_asked_for_once(storage: Storage, unit: Group) -> None:
    refresh_group(storage, unit, NOW)
    assert ask_for_outdated(storage, lambda: NOW) == 0
    with storage.database.writing() as store:
        for group in Groups(store).every():
            WorkQueue(store, WorkKind.GROUP).settle_each(WorkQueue(store, WorkKind.GROUP).tickets(group.place))
    assert [ask_for_outdated(storage, lambda: NOW) for _ in range(2)] == [2, 0]
