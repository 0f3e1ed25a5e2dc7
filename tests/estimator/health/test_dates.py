"""Stated dates on a slice of units' lives, and units that come back in time and not too early."""

import numpy as np
import pytest

from benchmarks.backtest.dates import SOURCES, Sample, fleets, held, statements

LIVES = SOURCES[-1]


@pytest.mark.slow
def test_dates_hold_about_as_often_as_they_claim() -> None:
    """The bounds are wide: one type gives a rate of 10 % to within a factor of two."""
    found = statements(LIVES, Sample(types=1), np.random.default_rng(31))
    assert held(found, lambda one: one.reach_90).share < 0.2
    low, high = held(found, lambda one: one.reach_50).interval()
    assert low < 0.5
    assert high > 0.42


@pytest.mark.slow
def test_stable_units_beside_one_bad_in_five_come_back_late_and_in_time() -> None:
    found = list(fleets(LIVES, 0.2, Sample(fleets=1), np.random.default_rng(32)))
    days = [365 * one.due for one in found if one.kind == "stable" and one.sessions >= 4]
    assert np.median(days) >= 330
    assert sum(one.passed < one.due for one in found) <= 2
