"""A fault is dated by when samples were taken, whatever is missing before it."""

import numpy as np
import pytest

from estimator.parity.taken import Taken

RATE = 50.0


def test_without_gaps_the_rows_follow_at_the_rate() -> None:
    taken = Taken(RATE)
    for _ in range(4):
        taken.add(np.ones(500, dtype=bool), None)
    assert taken.at(np.array([0.0, 12.3, 41.0])) == pytest.approx([0.0, 12.3, 41.0])


def test_rows_that_are_left_out_do_not_date_a_fault_early() -> None:
    used = np.ones(5000, dtype=bool)
    used[1000:1500] = False
    taken = Taken(RATE)
    taken.add(used, None)
    assert taken.at(30.0) == pytest.approx(40.0, abs=0.3)


def test_rows_that_the_file_lacks_are_known_by_its_times() -> None:
    time = np.delete(np.arange(6000) / RATE, slice(2000, 2900)) + 77.0
    taken = Taken(RATE)
    taken.add(np.ones(len(time), dtype=bool), time)
    assert taken.at(50.0) == pytest.approx(68.0, abs=0.3)
    assert taken.at(10.0) == pytest.approx(10.0)
