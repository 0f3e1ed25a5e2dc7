"""Rules that watch a parameter session by session: figures by hand, thresholds, delays."""

import numpy as np
import pytest

from benchmarks.backtest.histories import History
from benchmarks.backtest.watching import RULES, alarm, delays, one_step, size, summed, threshold, wald
from benchmarks.backtest.worlds import FIRST


def history(value: list[float], onset: float = 0.0) -> History:
    n = len(value)
    ones = np.ones(n)
    return History("step", np.zeros(9), onset, np.arange(n) * 0.5, np.array(value), ones, 21 * ones)


def test_page_s_sums_and_wald_s_ratios_by_hand() -> None:
    x = np.array([0.0, 2.0, 2.0, -4.0])
    assert summed(x).tolist() == [0.0, 1.5, 3.0, 3.5]
    assert wald(x) == pytest.approx([-0.5, 1.0, 2.5, 3.5])


def test_a_step_s_ratio_is_the_largest_of_all_places() -> None:
    assert one_step(history([0.0, 0.0, 3.0])) == pytest.approx([0.0, 0.0, 9 / 1.5])


def test_a_threshold_lets_one_alarm_in_a_hundred_years_through() -> None:
    rng = np.random.default_rng(1)
    sound = [history([0.0, *rng.standard_normal(40)]) for _ in range(50)]
    figures = [np.abs(one.value) for one in sound]
    level = threshold(figures, sound)
    assert 6 <= sum(alarm(one, level) is not None for one in figures) <= 10


def test_a_delay_counts_from_the_first_session_that_can_show_the_change() -> None:
    one = history([0.0] * 5, onset=0.6)
    figures = [np.array(f) for f in ([0, 0, 1.0, 0, 0], [0, 0, 0, 0, 1.0], [0, 1.0, 0, 0, 0], [0.0] * 5)]
    assert delays(figures, [one] * 4, 0.5) == [1, 3, None, None]


@pytest.mark.parametrize("name", RULES)
def test_every_rule_tells_a_large_step_from_nothing(name: str) -> None:
    still, moved = history([0.0, 0.1, -0.1, 0.0, 0.1, 0.0]), history([0.0, 0.1, -0.1, 9.0, 9.1, 9.0])
    assert RULES[name](moved).max() > 3 * RULES[name](still).max() + 1
    assert len(RULES[name](moved)) == 6


@pytest.mark.parametrize(("kind", "low", "high"), [("step", 0.4, 1.2), ("late ramp", 0.2, 0.8)])
def test_sizes_are_those_that_were_drawn(kind: str, low: float, high: float) -> None:
    made = FIRST.made(kind, FIRST.plan, np.random.default_rng(2))
    assert low <= size(made) <= high
