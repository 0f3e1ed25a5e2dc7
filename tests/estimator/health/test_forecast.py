"""Forecasts of histories: first passages, discs, new events, bounds that hold."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from estimator.health.forecast import AHEAD, earliest, future, passed, reach, staying, together
from estimator.health.pooled import Prior, general_prior, learn
from estimator.health.posterior import Draws
from estimator.health.prognosis import Track, evidence, prognosis
from estimator.health.shapes import Kind
from estimator.session import Array
from tests.estimator.health.histories import dates, measured, walk

NEVER = replace(general_prior(), rate=np.zeros_like(general_prior().rate))
"""A type in which nothing new happens."""
YEAR = np.array([1.0])


def draws(count: int, level: Array, rate: float = 0.0, strength: float = 0.0) -> Draws:
    """All alike; level (k,) T, rate T a year along the first component, strength T a root year."""
    k = len(level)
    moving = np.zeros((count, k))
    moving[:, 0] = rate
    flat = np.ones(count)
    kind = np.full(count, Kind.START if rate else Kind.NONE)
    return Draws(
        flat / count, np.tile(level, (count, 1)), moving, 0 * moving, flat, strength * flat, kind, 1.0, 0 * moving
    )


def chance_in(years: float, of: Draws, prior: Prior = NEVER, swing: float = 0.0) -> float:
    return float(np.interp(years, AHEAD, passed(of.weight, staying(of, prior, swing, np.random.default_rng(1)))))


def test_the_first_passage_of_a_drifting_walk_is_the_closed_form() -> None:
    """Whitmore (1986) without spread of the rate; the other side is far."""
    a, mu, q, t = 0.5, 0.2, 0.3, float(AHEAD[20])
    exact = stats.norm.cdf((mu * t - a) / (q * t**0.5)) + np.exp(2 * mu * a / q**2) * stats.norm.cdf(
        -(a + mu * t) / (q * t**0.5)
    )
    found = chance_in(t, draws(20_000, np.array([1 - a]), mu, q))
    assert found == pytest.approx(exact, abs=4 * np.sqrt(exact * (1 - exact) / 20_000) + 0.005)


def test_a_drift_passes_before_reach_90_in_one_history_of_five_and_a_found_one_in_ten_at_most() -> None:
    """One in eight draws drifts, at a rate from 0 to 1 T a year: over all, two thirds of them would have passed."""
    still, moving = draws(3500, np.zeros(1)), draws(500, np.zeros(1))
    rate = np.concatenate([still.rate, np.linspace(0.002, 1.0, 500)[:, None]])
    level, weight = np.zeros((4000, 1)), np.full(4000, 1 / 4000)
    kind = np.where(rate[:, 0] > 0, Kind.LATE, Kind.NONE)
    both = Draws(weight, level, rate, 0 * rate, np.ones(4000), np.zeros(4000), kind, 1.0, 0 * rate)
    stays = staying(both, NEVER, 0.0, np.random.default_rng(1))
    for is_found, share in ((False, 0.2), (True, 0.1)):
        date = earliest(both, stays, drifts=is_found)
        assert np.mean(rate[rate > 0] * date >= 1) == pytest.approx(share, abs=0.02)
    alone = replace(moving, rate=rate[3500:], kind=kind[3500:])
    stays = staying(alone, NEVER, 0.0, np.random.default_rng(1))
    assert earliest(alone, stays, drifts=False) == pytest.approx(1 / 0.9, rel=0.02)


def test_a_young_steep_drift_does_not_hide_behind_a_slow_old_one() -> None:
    """Three in four drift slowly from the start, one began late and is four times as steep: of it one in five at most
    passes before the date."""
    rate = np.concatenate([np.linspace(0.1, 0.2, 3000), np.linspace(0.4, 0.8, 1000)])[:, None]
    both = replace(draws(4000, np.zeros(1)), rate=rate, kind=np.repeat([Kind.START, Kind.LATE], [3000, 1000]))
    date = earliest(both, staying(both, NEVER, 0.0, np.random.default_rng(1)), drifts=False)
    assert np.mean(rate[3000:] * date >= 1) == pytest.approx(0.2, abs=0.02)


def test_an_axis_is_out_when_it_leaves_the_disc_not_a_square() -> None:
    """0.8 of the tolerance along both directions is 1.13 of it."""
    assert chance_in(0.0, draws(10, np.array([0.8, 0.8]))) == 1.0
    assert chance_in(5.0, draws(10, np.array([0.6, 0.6]))) == 0.0


@pytest.mark.parametrize("components", [1, 2])
def test_new_events_pass_the_tolerance_as_often_as_when_they_are_drawn(components: int) -> None:
    prior = replace(general_prior(), rate=20 * general_prior().rate)
    of = draws(40_000, np.full(components, 0.2))
    drawn = future(of, prior, np.linspace(0, 2, 81), np.random.default_rng(2)).level
    out = (np.linalg.norm(drawn, axis=1) >= 1).any(axis=1).mean()
    assert chance_in(2.0, of, prior) == pytest.approx(out, abs=0.02)


def test_a_swing_with_the_temperature_takes_room_from_the_tolerance() -> None:
    assert chance_in(1.0, draws(10, np.array([0.8])), swing=0.15) == 0.0
    assert chance_in(1.0, draws(10, np.array([0.8])), swing=0.25) == 1.0


def test_chances_of_parameters_of_one_type_multiply() -> None:
    assert together(np.array([[0.1, 0.5], [0.2, 0.5]])) == pytest.approx([0.28, 0.75])


def test_a_tolerance_that_is_passed_already_is_reached_at_once() -> None:
    rng = np.random.default_rng(6)
    t = dates(rng, 8)
    found = prognosis([measured(rng, t, 1.5 * t / t[-1], sigma=0.01)], [general_prior()], YEAR)
    assert found.outlooks[0].reach_90 == 0.0


def test_a_drift_that_was_found_goes_on_in_the_forecast() -> None:
    t = np.linspace(0, 2, 9)
    one = measured(np.random.default_rng(7), t, 0.3 * t, sigma=0.02)
    found = prognosis([one], [general_prior()], YEAR).outlooks[0]
    assert found.drift is not None
    assert found.reach_50 == pytest.approx((1 - 0.6) / 0.3, rel=0.2)
    assert found.fan.quantiles((0.5,), found.direction)[0, 0] == pytest.approx(0.9, abs=0.05)


@pytest.mark.slow
def test_bounds_hold_a_later_session_as_often_as_they_claim_in_a_type_that_is_known() -> None:
    """A third of the parameters drift, a third walk; the year after the last session."""
    rng = np.random.default_rng(8)
    tracks, later = [], []
    for i in range(120):
        t = np.append(dates(rng, 8, 2.5), 3.5)
        truth = (0.5 * t, walk(rng, t, 0.25), 0 * t)[i % 3]
        whole = measured(rng, t, truth, sigma=0.06)
        tracks.append(Track(t[:-1], whole.change[:-1], whole.sigma[:-1], 1.0))
        later.append((whole.change[-1], t[-1] - t[-2]))
    prior = learn([evidence(track) for track in tracks])
    below = [
        prognosis([track], [prior], np.array([ahead])).outlooks[0].fan.below(value, np.array([0.06]))[0]
        for track, (value, ahead) in zip(tracks, later, strict=True)
    ]
    held = np.sum((np.array(below) > 0.05) & (np.array(below) < 0.95))
    assert stats.binom.ppf(1e-3, 120, 0.9) <= held


def test_a_stable_unit_of_a_type_that_is_known_may_wait_the_whole_year() -> None:
    rng = np.random.default_rng(9)
    tracks = [measured(rng, dates(rng, 4, 1.5), np.zeros(4), sigma=0.1) for _ in range(120)]
    prior = learn([evidence(track) for track in tracks])
    risk = prognosis(tracks[:18], [prior] * 18, YEAR).risk
    assert reach(risk[None], 0.05)[0] > 0.9


def test_the_same_history_has_the_same_outlook_to_the_last_digit() -> None:
    one = measured(np.random.default_rng(10), np.linspace(0, 2, 6), np.zeros(6))
    first, again = (prognosis([one], [general_prior()], YEAR) for _ in range(2))
    assert (first.risk == again.risk).all()


def test_a_level_that_is_hardly_known_forecasts_nothing() -> None:
    found = prognosis([Track(np.array([0.0, 1.0]), np.zeros((2, 1)), np.full((2, 1), 3.0), 1.0)], [NEVER], YEAR)
    assert not found.outlooks[0].is_known
    assert found.risk.max() == 0


def test_an_axis_drifts_along_its_direction() -> None:
    rng = np.random.default_rng(11)
    t = dates(rng, 10)
    drift = 0.4 * t[:, None] * [0.6, 0.8]
    found = prognosis([measured(rng, t, drift, sigma=0.05)], [general_prior()], YEAR).outlooks[0]
    assert found.rate == pytest.approx(0.4, abs=3 * found.rate_sigma)
    assert found.direction == pytest.approx([0.6, 0.8], abs=0.15)


def test_a_type_that_settles_is_not_expected_to_go_on() -> None:
    """All end at 0.8 T. That aging may come to an end is learned from those that were watched until it did."""
    rng = np.random.default_rng(21)
    whole = [np.linspace(0, 4, 10) for _ in range(24)]
    prior = learn([evidence(measured(rng, t, -0.8 * np.expm1(-t), sigma=0.03)) for t in whole])
    young = np.linspace(0, 2, 8)
    found = prognosis([measured(rng, young, -0.8 * np.expm1(-young), sigma=0.03)], [prior], YEAR)
    assert found.outlooks[0].reach_50 == np.inf


def seasonal(rng: np.random.Generator, t: Array) -> Track:
    """0.05 T per °C in a hall with 4 °C of seasons."""
    warm = 20 + 4 * np.sin(2 * np.pi * (t + rng.uniform()))
    return replace(measured(rng, t, 0.05 * (warm - warm[0]), sigma=0.02), temperature=warm)


def test_in_a_type_that_follows_the_seasons_few_sessions_are_not_taken_for_a_drift() -> None:
    """One track has moved by 0.4 T between its two sessions, as much as eight degrees make; or did so at one
    temperature.
    """
    rng = np.random.default_rng(22)
    tracks = [seasonal(rng, dates(rng, 8)) for _ in range(16)]
    tracks += [measured(rng, t, 0.5 * t, sigma=0.02) for t in (dates(rng, 8, 2.0) for _ in range(8))]
    prior = learn([evidence(track) for track in tracks])
    young = Track(np.array([0.0, 0.5]), np.array([[0.0], [0.4]]), np.full((2, 1), 0.02), 1.0)
    alike, warmer = (
        prognosis([replace(young, temperature=np.array([16.0, end]))], [prior], YEAR).outlooks[0]
        for end in (16.0, 24.0)
    )
    assert alike.reach_50 < 3
    assert warmer.reach_50 > 10
    assert warmer.rate < alike.rate / 2


def test_what_a_walk_leaves_between_jumps_of_it_is_no_drift() -> None:
    """A jump back after two steady years: in a type of which a third walks both are of one walk."""
    rng = np.random.default_rng(23)
    times = [dates(rng, 8) for _ in range(30)]
    walks = (0.4, 0.0, 0.0)
    prior = learn([evidence(measured(rng, t, walk(rng, t, walks[i % 3]), sigma=0.04)) for i, t in enumerate(times)])
    value = np.array([0.0, 0.2, 0.36, 0.55, 0.7, 0.1, 0.12])[:, None]
    one = Track(np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.3, 2.6]), value, np.full((7, 1), 0.04), 1.0)
    found = prognosis([one], [prior], YEAR).outlooks[0]
    assert found.steps
    assert abs(found.rate) < 0.03


def test_who_was_quiet_for_long_is_expected_to_stay_so() -> None:
    prior = replace(general_prior(), rate=20 * general_prior().rate)
    young, old = (replace(draws(10, np.zeros(1)), age=age) for age in (0.5, 8.0))
    assert chance_in(2.0, old, prior) < 0.4 * chance_in(2.0, young, prior)


def test_one_that_has_changed_changes_again_as_units_in_general_do() -> None:
    prior = replace(general_prior(), rate=20 * general_prior().rate)
    jumped = replace(draws(10, np.zeros(1)), kind=np.full(10, Kind.JUMP))
    assert chance_in(2.0, jumped, prior) == pytest.approx(chance_in(2.0, jumped, general_prior()))
