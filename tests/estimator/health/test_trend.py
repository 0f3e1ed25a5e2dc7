"""Drift: exact likelihood, honest bounds, steps with the look-elsewhere effect, forecasts to the tolerance."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.forecast import AHEAD, EARLY, band, passage, predictive, reach, together
from estimator.health.prognosis import Track, prognosis
from estimator.health.state_space import DIFFUSE, RATE, WALKS, filtered
from estimator.health.trend import Series, Trends, padded, trends
from estimator.session import Array
from tests.estimator.health.histories import SIGMA, dates, measured, walk


def stated(series: Series, q: float) -> stats._multivariate.multivariate_normal_frozen:
    """The readings' joint distribution, written down without any recursion."""
    t, n = series.time - series.time[0], len(series.time)
    joint = DIFFUSE**2 + RATE**2 * np.outer(t, t) + q * np.minimum.outer(t, t) + np.diag(series.sigma**2)
    return stats.multivariate_normal(np.zeros(n), joint)


def test_the_likelihood_is_that_of_the_joint_normal_distribution() -> None:
    rng = np.random.default_rng(1)
    series = [measured(rng, t, walk(rng, t, 0.3)) for t in (dates(rng, 7), dates(rng, 4))]
    data = padded(series)
    found = filtered(data, np.zeros(data.there.shape, dtype=bool)).log_likelihood
    for row, one in zip(found, series, strict=True):
        exact = [stated(one, w**2).logpdf(one.value) + len(one.time) / 2 * np.log(2 * np.pi) for w in WALKS]
        assert row == pytest.approx(exact, rel=1e-9)


def test_levels_at_past_sessions_are_those_of_the_joint_distribution() -> None:
    """Conditional means and variances by direct inversion, mixed over the nodes."""
    rng = np.random.default_rng(2)
    t = dates(rng, 6)
    one = measured(rng, t, walk(rng, t, 0.3))
    found = trends([one], step_level=0.0)
    means, variances = [], []
    for w in WALKS:
        prior = DIFFUSE**2 + RATE**2 * np.outer(t, t) + w**2 * np.minimum.outer(t, t)
        gain = prior @ np.linalg.inv(prior + np.diag(one.sigma**2))
        means.append(gain @ one.value)
        variances.append(np.diagonal(prior - gain @ prior))
    weight = found.weight[0]
    mean = weight @ np.array(means)
    variance = weight @ (np.array(variances) + (np.array(means) - mean) ** 2)
    assert found.level[0] == pytest.approx(mean, abs=1e-6)
    assert found.level_sigma[0] == pytest.approx(np.sqrt(variance), rel=1e-3)


def test_a_short_series_beside_a_long_one_is_itself() -> None:
    rng = np.random.default_rng(3)
    short, long = (measured(rng, t, 0.2 * t) for t in (dates(rng, 4), dates(rng, 12)))
    alone, beside = trends([short]), trends([short, long])
    assert beside.rate[0] == pytest.approx(alone.rate[0])
    assert beside.p_value[0] == pytest.approx(alone.p_value[0])
    assert beside.mean[0] == pytest.approx(alone.mean[0])


def drawn(kind: str, runs: int, sessions: int = 10) -> list[Series]:
    """Histories of one kind."""
    rng = np.random.default_rng([4, sessions, *map(ord, kind)])
    made = []
    for _ in range(runs):
        t = dates(rng, sessions)
        truth = {"stable": 0 * t, "walk": walk(rng, t, 0.2), "ramp": 0.4 * t}.get(kind, np.where(t > 1.5, 1.2, 0.0))
        made.append(measured(rng, t, truth))
    return made


@pytest.mark.parametrize("kind", ["stable", "walk"])
def test_a_rate_is_claimed_where_there_is_none_as_rarely_as_stated(kind: str) -> None:
    p = trends(drawn(kind, 600)).p_value
    for level in (0.05, 0.01):
        assert (p < level).sum() <= stats.binom.isf(1e-3, 600, level)


def test_a_ramp_is_found_with_its_rate() -> None:
    found = trends(drawn("ramp", 300))
    pulls = (found.rate - 0.4) / found.rate_sigma
    assert (np.abs(pulls) < 2).mean() > 0.93
    assert (found.p_value < 0.05).mean() > 0.6


@pytest.mark.parametrize("kind", ["stable", "walk", "ramp"])
def test_a_step_is_claimed_where_there_is_none_as_rarely_as_stated(kind: str) -> None:
    found = trends(drawn(kind, 600)).steps.any(axis=1).sum()
    assert found <= stats.binom.isf(1e-3, 600, 0.01)


def test_a_step_is_found_where_it_was() -> None:
    series = drawn("step", 300)
    found = trends(series)
    first = [int(np.argmax(s.time > 1.5)) for s in series]
    hits = [bool(row[k]) for row, k in zip(found.steps, first, strict=True) if 2 <= k <= 8]
    assert np.mean(hits) > 0.65
    assert np.abs(found.rate).mean() < 0.15, "a step is no drift"


def test_bounds_hold_a_later_session_as_often_as_they_claim() -> None:
    inside = {}
    for kind in ("stable", "walk", "ramp"):
        series = drawn(kind, 600, sessions=10)
        cut = [Series(s.time[:-2], s.value[:-2], s.sigma[:-2], 1.0) for s in series]
        ahead = np.array([s.time[-2:] - s.time[-3] for s in series])
        value, sigma = np.array([s.value[-2:] for s in series]), np.full((600, 2), SIGMA)
        inside[kind] = predictive(trends(cut), ahead, value, sigma)[:, 1]
    for kind, below in inside.items():
        held = ((below > 0.05) & (below < 0.95)).sum()
        assert held >= stats.binom.ppf(1e-3, 600, 0.9), kind


def test_the_closed_form_of_the_first_passage_is_that_of_simulated_paths() -> None:
    found = trends(drawn("ramp", 1, sessions=5))
    stated_chance = passage(found)[0]
    simulated = paths(found, np.random.default_rng(5))
    for years in (1.0, 2.0, 4.0):
        assert np.interp(years, AHEAD, stated_chance) == pytest.approx(simulated[round(years * 500) - 1], abs=0.035)


def paths(found: Trends, rng: np.random.Generator, runs: int = 3000) -> Array:
    """Share of simulated futures that have passed the tolerance, 500 steps a year, four years."""
    node = rng.choice(len(WALKS), runs, p=found.weight[0])
    mean, (p00, p01, p11) = found.mean[0, node], found.covariance[0, node].T
    level = mean[:, 0] + np.sqrt(p00) * rng.standard_normal(runs)
    rate = mean[:, 1] + p01 / p00 * (level - mean[:, 0]) + np.sqrt(p11 - p01**2 / p00) * rng.standard_normal(runs)
    passed, share = np.abs(level) >= 1, []
    for _ in range(2000):
        level = level + rate / 500 + WALKS[node] * np.sqrt(1 / 500) * rng.standard_normal(runs)
        passed |= np.abs(level) >= 1
        share.append(passed.mean())
    return np.array(share)


def test_a_level_ahead_is_that_before_a_later_session_that_measures_nothing() -> None:
    """Node by node; the later session's sigma is a million tolerances."""
    rng = np.random.default_rng(9)
    t = dates(rng, 6)
    one = measured(rng, t, walk(rng, t, 0.3))
    later = Series(np.append(t, t[-1] + 1.5), np.append(one.value, 0.0), np.append(one.sigma, 1e6), 1.0)
    mean, variance = trends([one], step_level=0.0).at(np.array([[1.5]]))
    found = trends([later], step_level=0.0)
    assert mean[0, :, 0] == pytest.approx(found.mean[0, :, 0], rel=1e-6)
    assert variance[0, :, 0] == pytest.approx(found.covariance[0, :, 0], rel=1e-6)


def test_quantiles_of_the_band_hold_what_they_name() -> None:
    found, ahead = trends(drawn("walk", 5)), np.tile([0.5, 2.0], (5, 1))
    edge = band(found, ahead, (0.05, 0.5)).quantiles
    for k, level in enumerate((0.05, 0.5)):
        assert predictive(found, ahead, edge[:, k], np.zeros((5, 2))) == pytest.approx(level, abs=1e-6)


def test_a_tolerance_that_is_passed_already_is_reached_at_once() -> None:
    rng = np.random.default_rng(6)
    t = dates(rng, 8)
    chance = passage(trends([measured(rng, t, 0.9 * t, sigma=0.01)]))
    assert reach(chance, EARLY)[0] == 0.0


def test_chances_of_independent_parameters_multiply() -> None:
    assert together(np.array([[0.1, 0.5], [0.2, 0.5]])) == pytest.approx([0.28, 0.75])


def axis_track(rng: np.random.Generator, drift: float) -> Track:
    """Ten sessions of an axis that drifts along (0.6, 0.8); tolerance 20, sigma 1, three years."""
    t = dates(rng, 10)
    change = drift * t[:, None] * [0.6, 0.8] + rng.standard_normal((10, 2))
    change[0] = 0.0
    return Track(t, change, np.ones((10, 2)), 20.0)


def test_an_axis_drifts_along_its_direction_and_keeps_its_level_of_false_alarms() -> None:
    rng = np.random.default_rng(7)
    drifting = prognosis([axis_track(rng, 6.0)]).outlooks[0]
    assert drifting.rate == pytest.approx(6.0, abs=3 * drifting.rate_sigma)
    assert drifting.level > 0
    still = prognosis([axis_track(rng, 0.0) for _ in range(400)]).outlooks
    assert sum(o.p_value < 0.05 for o in still) <= stats.binom.isf(1e-3, 400, 0.05)


def test_a_direction_chosen_by_looking_has_the_p_value_of_the_largest_of_all() -> None:
    """exp(−t²/2), where one number alone would have 2Φ(−|t|)."""
    rng = np.random.default_rng(7)
    track = axis_track(rng, 0.0)
    found = prognosis([track])
    t = stats.norm.isf(found.trends.p_value[0] / 2)
    assert found.outlooks[0].p_value == pytest.approx(np.exp(-(t**2) / 2))


def test_an_outlook_does_not_depend_on_the_unit_of_measurement() -> None:
    one = axis_track(np.random.default_rng(12), 6.0)
    same = prognosis([Track(one.time, 10 * one.change, 10 * one.sigma, 10 * one.tolerance)]).outlooks[0]
    found = prognosis([one]).outlooks[0]
    assert (same.level_sigma, same.rate_sigma) == pytest.approx((10 * found.level_sigma, 10 * found.rate_sigma))


def test_a_sudden_change_is_found_in_a_unit_of_several_parameters() -> None:
    rng = np.random.default_rng(11)
    still = axis_track(rng, 0.0)
    change = np.where(np.arange(10) >= 5, 15.0, 0.0)[:, None] + rng.standard_normal((10, 1))
    found = prognosis([still, Track(np.linspace(0, 3, 10), change, np.ones((10, 1)), 20.0)]).outlooks
    assert [o.steps for o in found] == [(), (5,)]


def test_the_unit_s_risk_is_that_of_all_its_parameters() -> None:
    rng = np.random.default_rng(8)
    drifting, still = axis_track(rng, 6.0), axis_track(rng, 0.0)
    found = prognosis([drifting, Track(drifting.time, still.change, still.sigma, still.tolerance)])
    both = 1 - (1 - found.outlooks[0].chance) * (1 - found.outlooks[1].chance)
    assert found.risk == pytest.approx(both)
    assert found.outlooks[0].reach_90 < found.outlooks[1].reach_90


def test_a_level_that_is_hardly_known_forecasts_nothing() -> None:
    t = np.array([0.0, 1.0])
    found = prognosis([Track(t, np.zeros((2, 1)), np.full((2, 1), 3.0), 1.0)])
    assert not found.outlooks[0].is_known
    assert found.risk.max() == 0
