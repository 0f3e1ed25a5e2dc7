"""The back-test of the documentation runs, and its bounds hold on histories that it has not shown."""

from scipy import stats

from benchmarks.backtest.coverage import coverage_page, outcomes
from benchmarks.backtest.detection import detection_page

HISTORIES = 60


def test_bounds_hold_over_all_kinds_of_histories() -> None:
    found = outcomes(HISTORIES, seed=77)
    for name in ("next", "last"):
        inside = sum(abs(getattr(outcome, name) - 0.5) <= 0.45 for outcome in found)
        assert inside >= stats.binom.ppf(1e-3, len(found), 0.9)
    early = sum(outcome.passed < outcome.early for outcome in found)
    assert early <= stats.binom.isf(1e-3, len(found), 0.1)
    assert "| **all** |" in coverage_page(found)


def test_every_rule_is_set_beside_ours() -> None:
    page = detection_page(20, seed=77)
    assert page.count("tuned on stable and wandering |") == 5
    assert "ruptures" in page
