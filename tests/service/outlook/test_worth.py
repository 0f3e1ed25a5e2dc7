"""Changes that get a flag: beyond the share of the tolerance that the type states, or before the due date."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest

from service.outlook.records import ChangeKind, FoundChange, ParameterTrend, RiskPoint, UnitOutlook
from service.records.flagging.drift import is_worth_a_flag
from service.types.records import Tolerances, UnitType

LATEST = datetime(2026, 1, 1, tzinfo=UTC)
YEAR = timedelta(days=365.25)
ANY = Tolerances(None, None, None, None)
TYPE = UnitType("V", "accelerometer", (), (), (), ANY, None, 1)
TREND = ParameterTrend(
    "A1", "bias", 0.0, 0.0, 1.0, (), 0.0, 0.0, reach_50=None, reach_90=None, population_z=None, tolerance=1.0
)


def outlook(due: datetime | None = LATEST + YEAR) -> UnitOutlook:
    risk = (RiskPoint(LATEST, 0.0),)
    return UnitOutlook("BA-1", due, False, "", None, None, None, None, None, (TREND,), risk=risk)


def change(kind: ChangeKind, size: float) -> FoundChange:
    return FoundChange(kind, LATEST - YEAR, LATEST, size, 0.001, 1e-6)


@pytest.mark.parametrize("kind", ["jump", "drift", "aging", "walk"])
def test_a_change_has_a_flag_from_the_share_of_the_tolerance_on(kind: ChangeKind) -> None:
    found = [is_worth_a_flag(TREND, change(kind, size), outlook(), TYPE) for size in (0.29, -0.31, 0.31)]
    assert found == [False, True, True]
    other = replace(TYPE, flag_share=0.1)
    assert is_worth_a_flag(TREND, change(kind, 0.11), outlook(), other)


def test_a_drift_counts_by_what_it_adds_until_the_due_date_and_in_a_year_at_least() -> None:
    slow, late, soon = change("drift", 0.2), outlook(LATEST + 2 * YEAR), outlook(LATEST + YEAR / 4)
    assert [is_worth_a_flag(TREND, slow, of, TYPE) for of in (late, outlook(), soon)] == [True, False, False]
    assert is_worth_a_flag(TREND, change("drift", 0.35), soon, TYPE)


@pytest.mark.parametrize("kind", ["drift", "aging", "walk"])
def test_what_may_pass_the_tolerance_before_the_due_date_has_one_however_slow_it_is(kind: ChangeKind) -> None:
    near, far = (replace(TREND, reach_90=LATEST + YEAR * years) for years in (0.9, 1.1))
    small = change(kind, 0.02)
    assert [is_worth_a_flag(trend, small, outlook(), TYPE) for trend in (near, far)] == [True, False]


def test_a_jump_is_over_and_does_not_pass_anything() -> None:
    near = replace(TREND, reach_90=LATEST)
    assert not is_worth_a_flag(near, change("jump", 0.02), outlook(), TYPE)


def test_without_a_due_date_the_longest_interval_counts() -> None:
    near = replace(TREND, reach_90=LATEST + YEAR * 0.5)
    half = replace(TYPE, maximum_interval_days=100.0)
    assert [is_worth_a_flag(near, change("drift", 0.02), outlook(None), of) for of in (TYPE, half)] == [True, False]
