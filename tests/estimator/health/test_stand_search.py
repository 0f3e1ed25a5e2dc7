"""The dates at which a stand was turned, and turned back, among all dates of a stand with more sessions than are
spread.
"""

import numpy as np
import pytest

from estimator.health.stand_search import MOST_DATES
from estimator.health.stands import StandMotion, StandShift, stand_states
from estimator.session import Array

UNITS, SESSIONS = 40, 10
TURNED = np.array([12.0, 0.0, -16.0])


def fleet(turned: Array, wild: tuple[int, ...] = ()) -> tuple[list[StandMotion], Array]:
    """Forty units on two stands in turn, and the dates of the first of them, on which blocks are ``turned`` at given
    sessions (s,); ``wild`` mountings are out by three times as much besides."""
    rng = np.random.default_rng(8)
    times = np.sort(rng.uniform(0, 3, UNITS * SESSIONS))
    at = np.arange(0, len(times), 2)
    poses = 2 * rng.standard_normal((len(times), 3))
    poses[at[turned]] += TURNED
    poses[at[list(wild)]] += 3 * TURNED
    first: dict[int, Array] = {}
    motions = []
    for i, (time, pose) in enumerate(zip(times, poses, strict=True)):
        unit = (i * 7 // 2) % UNITS
        reference = first.setdefault(unit, pose)
        covariance = np.zeros((3, 3)) if reference is pose else 0.5 * np.eye(3)
        motions.append(StandMotion(f"S{i % 2}", f"U{unit}", float(time), pose - reference, covariance))
    return motions, times[at]


def shifts(motions: list[StandMotion]) -> tuple[StandShift, ...]:
    return stand_states(motions)[0].shifts


@pytest.mark.slow
def test_an_excursion_that_four_sessions_of_many_saw_has_its_very_dates() -> None:
    for start in range(91, 97, 2):
        motions, dates = fleet(np.arange(start, start + 4))
        assert len(dates) > MOST_DATES
        assert [(s.since, s.until) for s in shifts(motions)] == [(dates[start], dates[start + 4])]


def test_a_long_excursion_has_its_very_dates() -> None:
    motions, dates = fleet(np.arange(31, 130))
    assert [(s.since, s.until) for s in shifts(motions)] == [(dates[31], dates[130])]


def test_a_terrible_mounting_within_an_excursion_is_no_excursion_of_its_own() -> None:
    motions, _ = fleet(np.arange(91, 98), wild=(91,))
    assert len(shifts(motions)) == 1
