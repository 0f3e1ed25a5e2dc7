"""What groups of sessions show is made beside the requests, by one process at a time."""

from collections.abc import Iterator
from datetime import UTC, datetime
from threading import Event

import pytest

from service.background.bell import Bell
from service.background.diagnose_waiting import CLAIM, Diagnosing
from service.background.helper import Helper
from service.background.pool_waiting import ask_for_outdated, pool_next
from service.flows.receive import upload
from service.flows.refresh_group import current, refresh_group
from service.metrics import Metrics
from service.records.group import Group, Level
from service.settings import Settings
from service.storage import Storage
from tests.databases import one_engine
from tests.service.grouped import GROUP

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


@pytest.fixture
def unit(storage: Storage) -> Group:
    """A unit of two sessions, whose groups are asked for."""
    for content in GROUP[:2]:
        upload(storage, content, "a.json", NOW)
    with storage.database.reading() as store:
        return store.groups.find(Level.UNIT, "BA-017")


@pytest.fixture
def helper(settings: Settings) -> Iterator[Helper]:
    """A process that makes what is asked for."""
    started = Helper(settings)
    yield started
    started.end()


def waiting(storage: Storage, now: datetime = NOW) -> list[Level]:
    with storage.database.reading() as store:
        return [group.level for group in store.pending_groups.waiting(now, 10)]


@one_engine
def test_a_process_of_its_own_makes_one_after_another(
    settings: Settings, storage: Storage, unit: Group, helper: Helper
) -> None:
    own = Diagnosing(settings, storage, lambda: NOW, Metrics(), Bell())
    made = [pool_next(own, helper, Event()) for _ in range(4)]
    assert (made, waiting(storage)) == ([True, True, True, False], [])
    with storage.database.reading() as store:
        answer = current(store, unit)
    assert answer is not None
    assert answer.sessions == 2


def test_one_process_claims_a_group_at_a_time(storage: Storage, unit: Group) -> None:
    for got in (1, None):
        with storage.database.writing() as store:
            assert store.pending_groups.claim(unit, NOW, NOW + CLAIM) == got
    assert Level.UNIT not in waiting(storage)
    assert Level.UNIT in waiting(storage, NOW + CLAIM)


def test_who_asks_while_it_is_made_is_not_settled_with_it(storage: Storage, unit: Group) -> None:
    with storage.database.reading() as store:
        asked = store.pending_groups.asked(unit)
    upload(storage, GROUP[2], "a.json", NOW)
    with storage.database.writing() as store:
        store.pending_groups.settle(asked)
    assert Level.UNIT in waiting(storage)


def test_groups_without_an_answer_of_now_are_asked_for_once(storage: Storage, unit: Group) -> None:
    refresh_group(storage, unit, NOW)
    assert ask_for_outdated(storage, lambda: NOW) == 0
    with storage.database.writing() as store:
        for group in store.groups.every():
            store.pending_groups.settle(store.pending_groups.asked(group))
    assert [ask_for_outdated(storage, lambda: NOW) for _ in range(2)] == [2, 0]
