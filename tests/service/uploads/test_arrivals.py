"""Uploads in the order in which they came, stored and refused, and how the list is read on."""

from collections.abc import Iterator
from contextlib import suppress
from datetime import UTC, datetime, timedelta

import pytest

from service.errors import NotFoundError, RefusedError
from service.storage import Storage
from service.uploads.receive import upload
from service.uploads.records import Arrival, ArrivalQuery
from service.uploads.store import Arrivals
from tests.conftest import Filled
from tests.service.made_sessions import session_bytes

NOON = datetime(2026, 11, 21, 12, tzinfo=UTC)


def arrive(storage: Storage) -> None:
    """Two sessions and two refusals at noon, one of each an hour later."""
    for month, hour, name in ((1, 0, "a"), (2, 0, "b"), (3, 1, "c")):
        upload(storage, session_bytes(month=month, seed=month), f"{name}.json", NOON + timedelta(hours=hour))
    for text, hour, name in ((b"1", 0, "d"), (b"2", 0, "e"), (b"3", 1, "f")):
        with suppress(RefusedError):
            upload(storage, text, f"{name}.json", NOON + timedelta(hours=hour))


@pytest.fixture
def stored(filled: Filled) -> Storage:
    return filled(arrive)


def letter(arrival: Arrival) -> str:
    """First letter of the file's name."""
    known = arrival.session or arrival.refusal
    assert known is not None
    return known.filename[0]


def read_on(storage: Storage, at_once: int) -> Iterator[str]:
    """The whole list, some at a time."""
    query = ArrivalQuery(limit=at_once)
    while True:
        with storage.database.reading() as store:
            found = Arrivals(store).page(query)
        if not found:
            return
        yield from map(letter, found)
        last = found[-1]
        query = ArrivalQuery(
            after_session=None if last.session is None else last.session.id,
            after_refusal=None if last.refusal is None else last.refusal.number,
            limit=at_once,
        )


def test_what_came_is_listed_newest_first_and_read_on_without_a_gap(stored: Storage) -> None:
    whole = "".join(read_on(stored, 100))
    assert (whole[:2], sorted(whole[2:4]), sorted(whole[4:])) == ("fc", ["d", "e"], ["a", "b"])
    assert ["".join(read_on(stored, at_once)) for at_once in (1, 2, 5)] == [whole] * 3


def test_a_list_is_narrowed(stored: Storage) -> None:
    with stored.database.reading() as store:
        refused = Arrivals(store).page(ArrivalQuery(refused=True))
        named = Arrivals(store).page(ArrivalQuery(text="A.JSON"))
        anew = Arrivals(store).page(ArrivalQuery(after_session="none", limit=1))
    assert ("".join(map(letter, refused)), "".join(map(letter, named)), letter(anew[0])) == ("fed", "a", "f")


def test_a_refusal_keeps_its_problems(stored: Storage) -> None:
    with stored.database.reading() as store:
        last = Arrivals(store).page(ArrivalQuery(refused=True))[0].refusal
        assert last is not None
        assert Arrivals(store).refusal(last.number) == last
        assert last.problems
        with pytest.raises(NotFoundError):
            Arrivals(store).refusal(10**6)
