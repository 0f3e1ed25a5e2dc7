"""Writers come in the order in which they asked, and nobody waits for ever."""

from threading import Event, Thread
from time import sleep

import pytest

from service.errors import AwayError
from service.storage.waits import FairLock


def waiting(turns: FairLock, name: int, seen: list[int]) -> Thread:
    """One that waits in line when this returns."""
    before = len(turns)

    def take() -> None:
        with turns.taken():
            seen.append(name)

    thread = Thread(target=take)
    thread.start()
    while len(turns) == before:
        sleep(0)
    return thread


def test_nobody_overtakes() -> None:
    turns, seen = FairLock(60.0), list[int]()
    with turns.taken():
        threads = [waiting(turns, name, seen) for name in range(8)]
    for thread in threads:
        thread.join()
    assert seen == list(range(8))


def test_who_waits_too_long_gives_up_and_the_next_comes_all_the_same() -> None:
    turns = FairLock(0.05)
    with turns.taken(), pytest.raises(AwayError), turns.taken():
        pass
    with turns.taken():
        assert len(turns) == 1


def test_who_waits_in_a_long_line_that_moves_is_not_refused() -> None:
    turns, seen = FairLock(1.5), list[int]()
    ends = [Event() for _ in range(8)]

    def take(name: int) -> None:
        with turns.taken():
            ends[name].wait(0.25)  # all of them together outlast the patience of one
            seen.append(name)

    with turns.taken():
        threads = [Thread(target=take, args=(name,)) for name in range(8)]
        for place, thread in enumerate(threads, 2):
            thread.start()
            while len(turns) < place:
                sleep(0)
    for thread in threads:
        thread.join()
    assert seen == list(range(8))


def test_a_turn_that_ends_in_an_error_is_over() -> None:
    turns = FairLock(0.05)
    with pytest.raises(ZeroDivisionError), turns.taken():
        raise ZeroDivisionError
    with turns.taken():
        assert len(turns) == 1
