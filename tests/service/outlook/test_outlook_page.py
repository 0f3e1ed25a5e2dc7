"""Due dates in words and in charts, and the outliers of the fleet."""

from dataclasses import replace
from datetime import timedelta

import pytest

from service.fleet.condition import FleetCondition
from service.outlook.charts import history_charts, tracks_of
from service.outlook.records import (
    FanPoint,
    FoundChange,
    ParameterTrend,
    Rate,
    RiskPoint,
    TemperatureCoefficient,
    UnitOutlook,
)
from service.outlook.rules.populations import Standout, populations, standouts
from service.outlook.store import FarOut
from service.outlook.words import next_calibration
from service.pages.fleet.pages import fleet_page
from service.pages.fleet.view import FleetView
from service.sessions.decision import Verdict
from tests.service.pages.records import NOON, bias_point, unit_summary, uses_of

MICRO_G = 9.80665e-6
YEAR = timedelta(days=365.25)
DRIFT = ParameterTrend(
    sensor="A1", parameter="bias", rate_per_year=12 * MICRO_G, rate_sigma=1.5 * MICRO_G, significance=1e-6,
    step_dates=(), level=30 * MICRO_G, level_sigma=2 * MICRO_G, reach_50=NOON + 2 * YEAR, reach_90=NOON + YEAR,
    population_z=None, kind="accelerometer", tolerance=50 * MICRO_G, since=NOON,
    changes=(FoundChange("drift", NOON, NOON + YEAR / 4, 12 * MICRO_G, 1.5 * MICRO_G, 1e-6),),
    fan=tuple(FanPoint(NOON + k * YEAR, *(MICRO_G * (30 + 12 * k + d) for d in (-9, -4, 0, 4, 9))) for k in range(2)),
)  # fmt: skip
STILL = replace(DRIFT, sensor="A2", rate_per_year=0.0, significance=0.6, level=2 * MICRO_G, changes=())
OUTLOOK = UnitOutlook(
    serial="BA-017", due=NOON + YEAR, overdue=False, reason="A1 bias reaches its tolerance.", sensor="A1",
    parameter="bias", reach_50=NOON + 2 * YEAR, reach_90=NOON + YEAR, risk_at_due=0.05, trends=(DRIFT, STILL),
    unit_type="RA-6", risk=(RiskPoint(NOON, 0.0), RiskPoint(NOON + 2 * YEAR, 0.4)),
)  # fmt: skip


def test_what_drifts_is_said_with_its_date_and_what_does_not_is_not() -> None:
    assert next_calibration(OUTLOOK, NOON).moving == (
        "A1 bias has drifted at +12.0\u00a0±\u00a03.0\u202fµg a year since 1 Mar 2026; tolerance ±50 µg.",
    )
    quiet = next_calibration(replace(OUTLOOK, trends=(STILL,)), NOON).moving
    assert quiet == ("No parameter has changed significantly.",)


def test_what_has_moved_far_without_a_steady_rate_is_not_called_still() -> None:
    wandered = replace(STILL, level=-152 * MICRO_G)
    assert next_calibration(replace(OUTLOOK, trends=(wandered, STILL)), NOON).moving == (
        "A2 bias has changed by −152.0\u00a0±\u00a04.0\u202fµg, at no steady rate; tolerance ±50 µg.",
    )


def test_a_jump_lies_between_two_dates_and_has_a_size() -> None:
    jump = FoundChange("jump", NOON, NOON + timedelta(days=60), 20 * MICRO_G, 1.5 * MICRO_G, 1e-9)
    jumped = replace(STILL, changes=(jump,))
    assert next_calibration(replace(OUTLOOK, trends=(jumped,)), NOON).moving == (
        "A2 bias jumped by +20.0\u00a0±\u00a03.0\u202fµg between 1 Mar 2026 and 30 Apr 2026; tolerance ±50 µg.",
    )


def test_a_parameter_that_follows_the_temperature_is_said_to() -> None:
    warm = replace(STILL, temperature=TemperatureCoefficient(1.2 * MICRO_G, 0.1 * MICRO_G, 1e-9, is_found=True))
    assert next_calibration(replace(OUTLOOK, trends=(warm,)), NOON).moving == (
        "A2 bias depends on the temperature of the session (+1.20\u00a0±\u00a00.20\u202fµg per °C); "
        "the trend is stated without this effect.",
    )


def test_the_risk_of_waiting_starts_today_and_grows_with_the_date() -> None:
    waits = next_calibration(OUTLOOK, NOON + 0.5 * YEAR).waits
    assert [wait.day for wait in waits] == ["31 Aug 2026", "30 Nov 2026", "1 Mar 2027", "1 Mar 2027", "31 Aug 2027"]
    assert [waits[0].risk, waits[3].risk] == ["10\u202f%", "20\u202f%"]
    assert next_calibration(replace(OUTLOOK, risk=()), NOON).waits == ()


def test_a_chart_draws_the_trend_and_its_fan_in_people_s_units() -> None:
    (tracks,) = tracks_of([bias_point(0, 0.0), bias_point(9, 30 * MICRO_G)], ())
    data = history_charts(tracks, (), trends=(DRIFT, STILL)).panels[0].datasets
    assert [point["y"] for point in data["fan"]] == [30.0, 42.0]
    assert data["fan"][1]["hi9"] == 51.0
    assert [point["y"] for point in data["trend"]] == [30.0, 30.0]


def test_a_chart_without_a_trend_draws_none() -> None:
    (tracks,) = tracks_of([bias_point(0, 0.0)], ())
    data = history_charts(tracks, ()).panels[0].datasets
    assert (data["fan"], data["trend"]) == ([], [])


def test_the_fleet_page_marks_what_is_overdue() -> None:
    condition = FleetCondition(units=2, verdicts=dict.fromkeys(Verdict, 0), simulated=0)
    units = [replace(unit_summary("U1"), due=NOON - YEAR), replace(unit_summary("U2"), due=NOON + YEAR)]
    page = fleet_page(condition, units, uses_of(*units), FleetView(), overdue=1)
    assert [row.overdue for row in page.rows] == [True, False]
    assert [(one.words, one.url) for one in page.concerns] == [("1 is overdue", "/?due=overdue&sort=due")]


def rates_of(units: int) -> list[Rate]:
    """Rates of units of one type whose biases drift a little, in two lots."""
    return [
        Rate("RA-6", "L1" if i % 2 else "L2", f"U{i}", "A1", "accelerometer", "bias", 0.02 * (i % 5 - 2), 0.03)
        for i in range(units)
    ]


def found_in(rates: list[Rate]) -> tuple[Standout, ...]:
    """Outliers of a fleet of one type."""
    made = populations(rates)
    return standouts(FarOut(made, sum(one.rates for one in made), sum(one.lots for one in made)))


def test_a_unit_that_drifts_unlike_the_others_is_named() -> None:
    wild = replace(rates_of(1)[0], serial="W", value=0.24)
    assert [(s.unit, s.text) for s in found_in([*rates_of(20), wild])] == [
        ("W", "A1 bias drifts by 24 % of its tolerance a year, unlike the other units of its type.")
    ]


@pytest.mark.parametrize("value", [0.24, -0.24])
def test_a_drift_matters_upwards_and_downwards(value: float) -> None:
    [population] = populations([*rates_of(20), replace(rates_of(1)[0], serial="W", value=value)])
    assert [(one.serial, one.value) for one in population.fast] == [("W", value)]


def test_a_lot_that_drifts_unlike_the_others_is_named() -> None:
    lot = [replace(rate, serial=f"X{i}", lot="L9", value=0.09) for i, rate in enumerate(rates_of(8))]
    assert [s.text for s in found_in([*rates_of(24), *lot])] == [
        "Lot L9 of RA-6: bias drifts unlike in the other units."
    ]
