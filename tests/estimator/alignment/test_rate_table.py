"""A rate table tells E_xz and E_yz whatever the zeros and the Earth's rotation are, with honest sigmas."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from estimator import rate_table
from estimator.alignment.simulate import Truth, simulate_rate_table, triads
from estimator.errors import ScheduleError
from estimator.results import ARCSEC
from estimator.session import CalibrationSession, Site
from estimator.simulate import cone
from tests.estimator.alignment.cases import DEGREE_PER_HOUR, SITE

RUNS = ((0.2, 130.0), (0.0, 10.0), (-0.2, 130.0), (0.4, 70.0), (-0.4, 70.0))
TRUTH = Truth(
    gyro_bias=np.array([0.3, -0.2, 0.1]) * DEGREE_PER_HOUR, mounting=(4 * ARCSEC, -8 * ARCSEC), kappa=2e-5, heading=0.4
)


def measured(seed: int = 1, runs: tuple[tuple[float, float], ...] = RUNS, truth: Truth = TRUTH) -> CalibrationSession:
    return simulate_rate_table(triads(), SITE, runs, truth, np.random.default_rng(seed))


def test_errors_are_as_large_as_their_covariance_says() -> None:
    truth = np.array([*TRUTH.mounting, TRUTH.kappa, *TRUTH.gyro_bias])
    total = 0.0
    for seed in range(60):
        found = rate_table(measured(seed))
        error = found.estimate - truth
        total += float(error @ np.linalg.solve(found.covariance, error))
    low, high = chi2.ppf(np.array([0.001, 0.999]), 360)
    assert low < total < 1.4 * high, "1.4: a covariance of 15 turns is itself uncertain"


def test_where_sensors_stand_is_nothing_to_a_rate_table() -> None:
    """Gyros feel no lever arm, stated or not."""
    given = measured()
    placed = replace(given, sensors=tuple(replace(s, position=np.array([0.3, -0.2, 0.1])) for s in given.sensors))
    assert rate_table(placed).estimate == pytest.approx(rate_table(given).estimate, rel=1e-12)


def test_a_hundredth_of_an_arcsecond_is_told() -> None:
    found = rate_table(measured())
    assert found.parameter("E_xz").sigma == pytest.approx(0.015 * ARCSEC, rel=0.5)
    assert found.parameter("E_yz").value == pytest.approx(-8 * ARCSEC, abs=0.1 * ARCSEC)


def test_redundant_gyros_tell_the_same() -> None:
    block = triads(cone(6, np.radians(54.7), (0.0, 0.0, 1.0)))
    found = rate_table(simulate_rate_table(block, SITE, RUNS, TRUTH, np.random.default_rng(1)))
    assert found.parameter("E_xz").value == pytest.approx(4 * ARCSEC, abs=0.1 * ARCSEC)
    assert found.parameter("kappa_z").value == pytest.approx(2e-5, abs=1e-6)


def test_without_latitude_the_azimuth_zero_is_not_known() -> None:
    found = rate_table(replace(measured(), site=Site()))
    assert found.parameter("eps_z").value is None
    assert found.parameter("eps_x").value is not None


def test_stated_standard_errors_are_tested() -> None:
    session = measured()
    noise = np.full_like(session.standard_errors, 0.06 * ARCSEC / np.sqrt(0.1))
    fit = rate_table(replace(session, standard_errors=noise)).fit
    assert fit.noise == "stated"
    assert fit.p_value is not None
    assert 1e-3 < fit.p_value < 0.999


@pytest.mark.parametrize(
    ("runs", "message"),
    [
        (((0.2, 130.0),), "no whole turn at a negative rate"),
        (((0.2, 20.0), (-0.2, 20.0)), r"rows 1 to 200 at 11.4592 °/s cover 0.64 of a turn"),
        (((0.0, 100.0),), "the table never turns"),
        (((0.2, 40.0), (-0.2, 40.0)), "contains 2 whole turns; at least 6 are needed"),
    ],
)
def test_what_cannot_be_used_is_said(runs: tuple[tuple[float, float], ...], message: str) -> None:
    with pytest.raises(ScheduleError, match=message):
        rate_table(measured(runs=runs))


def test_a_table_that_turns_the_other_way_is_noticed() -> None:
    session = measured()
    assert session.turn_rate is not None
    with pytest.raises(ScheduleError, match="check the sign and unit of turn_rate_deg_s"):
        rate_table(replace(session, turn_rate=-session.turn_rate))
