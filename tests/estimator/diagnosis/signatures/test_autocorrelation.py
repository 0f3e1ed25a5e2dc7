"""Scatter without a pattern: noise in excess, or a course that runs smoothly along some order of the rows."""

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from estimator import Diagnosis, diagnose
from estimator.diagnosis.signatures.autocorrelation import SIGNAL, along, bayes_factors
from estimator.session import ACCELEROMETER, Array
from tests.estimator.causes.hiding import scene, with_readings

WHERE = scene(ACCELEROMETER, 0)
ROWS = len(WHERE.world.session.readings)


def with_scatter(course: Array, seed: int) -> Diagnosis:
    """One sensor's readings with a course (R,) added, in its standard errors."""
    return diagnose(with_readings(WHERE.measured(seed), course[:, None] * WHERE.noise[0] * np.eye(6)[1]))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_noise_above_the_stated_one_is_excess_noise(seed: int) -> None:
    found = with_scatter(5 * np.random.default_rng(seed).standard_normal(ROWS), seed)
    assert [(f.cause, f.sensors) for f in found.findings] == [("excess-noise", ("A2",))]
    assert not found.unexplained


@pytest.mark.slow
def test_random_walks_are_no_noise() -> None:
    """One walk in some dozens happens to look like noise."""
    walks = [12 * np.cumsum(np.random.default_rng(seed).standard_normal(ROWS)) for seed in range(8)]
    found = [with_scatter(walk, seed) for seed, walk in enumerate(walks)]
    uneven = [f for f in found if f.unexplained]
    assert len(uneven) >= 7
    assert {s for f in uneven for where in f.structures for s in where.sensors} == {"A2"}


@pytest.mark.parametrize("known", [False, True])
def test_bayes_factors_keep_their_promise_under_noise(known: bool) -> None:
    """Expectation at most one (Markov), and far fewer than 1/B of sound courses reach B."""
    rng, place = np.random.default_rng(5), np.linspace(0, 1, 30)
    covariances = along(place)
    drawn = [
        np.logaddexp.reduce(bayes_factors(np.stack(covariances), y, known=known)) - np.log(len(covariances))
        for y in rng.standard_normal((400, 30))
    ]
    assert np.mean(np.exp(drawn)) < 1.3
    assert np.mean(np.array(drawn) > np.log(20)) < 0.02


@pytest.mark.parametrize(("known", "same"), [(False, True), (True, False)])
def test_where_the_noise_is_unknown_the_size_of_a_residual_says_nothing(known: bool, same: bool) -> None:
    rng, (walk, *_) = np.random.default_rng(1), along(np.linspace(0, 1, 30))
    y = np.cumsum(rng.standard_normal(30))
    assert (
        abs(bayes_factors(walk[None], 10 * y, known=known)[0] - bayes_factors(walk[None], y, known=known)[0]) < 1e-9
    ) == same


def test_a_bayes_factor_under_stated_noise_is_the_ratio_of_two_normal_densities() -> None:
    (walk, *_), y = along(np.linspace(0, 1, 12)), np.random.default_rng(2).standard_normal(12)
    covariance = walk * 12 / np.trace(walk)
    densities = [multivariate_normal(np.zeros(12), np.eye(12) + size * covariance).logpdf(y) for size in SIGNAL]
    noise = multivariate_normal(np.zeros(12), np.eye(12)).logpdf(y)
    assert bayes_factors(walk[None], y, known=True)[0] == pytest.approx(
        logsumexp(densities) - np.log(len(SIGNAL)) - noise
    )


@pytest.mark.parametrize("known", [False, True])
def test_what_wanders_is_evidence_against_noise(known: bool) -> None:
    walk, *_ = along(np.linspace(0, 1, 30))
    assert bayes_factors(walk[None], np.cumsum(np.random.default_rng(1).standard_normal(30)), known=known)[0] > 5


def test_a_sensor_that_jumps_again_and_again_has_no_name() -> None:
    steps = np.repeat([0.0, 30.0, -20.0, 25.0, -15.0, 10.0], ROWS // 6)
    found = with_scatter(np.concatenate([steps, steps[: ROWS - len(steps)]]), 1)
    assert found.unexplained
    assert sum(f.cause == "bias-jump" for f in found.findings) == 0
