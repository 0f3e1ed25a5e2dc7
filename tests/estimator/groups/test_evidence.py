"""Evidence that holds however often one looks, and amplitudes whose sigma is honest."""

import numpy as np
import pytest

from estimator.groups.evidence import log_bayes, log_since, log_varying
from estimator.groups.priors import ALPHA, SPREADS, STRENGTHS
from estimator.groups.random_effects import mean_of

LIVES, LOOKS = 4000, 60


def scores(rng: np.random.Generator, width: int) -> tuple[np.ndarray, np.ndarray]:
    """(looks, lives, w) scores without an effect, and their information (looks, lives, w, w)."""
    root = rng.normal(size=(LOOKS, 1, width, width)) + 2 * np.eye(width)
    F = root @ np.swapaxes(root, -1, -2) * np.ones((1, LIVES, 1, 1))
    U = (root @ rng.standard_normal((LOOKS, LIVES, width, 1)))[..., 0]
    return U, F


@pytest.mark.parametrize("width", [1, 2])
def test_without_an_effect_the_evidence_hardly_ever_gets_large_whenever_one_looks(width: int) -> None:
    """Ville's bound: 1 % of 4000 lives is 40; 60 would be a one-in-a-thousand accident."""
    U, F = scores(np.random.default_rng(width), width)
    values = log_bayes(U.cumsum(axis=0), F.cumsum(axis=0), F[0])
    assert (values.max(axis=0) >= -np.log(ALPHA)).sum() < 60


def test_an_effect_that_differs_every_time_does_not_appear_by_chance() -> None:
    U, F = scores(np.random.default_rng(3), 1)
    statistic = (U[..., 0] ** 2 / F[..., 0, 0]).cumsum(axis=0)
    freedom = np.arange(1, LOOKS + 1)[:, None] * np.ones(LIVES)
    values = np.array([log_varying(s, f) for s, f in zip(statistic, freedom, strict=True)])
    assert (values.max(axis=0) >= -np.log(ALPHA)).sum() < 60


def test_nor_does_one_that_began_some_day() -> None:
    U, F = scores(np.random.default_rng(4), 1)
    looks = range(4, LOOKS, 4)
    largest = np.max([np.logaddexp.reduce(log_since(U[:k], F[:k]), axis=0) for k in looks], axis=0)
    assert (largest >= -np.log(ALPHA)).sum() < 60


def test_evidence_is_soon_there_where_the_effect_is() -> None:
    """Strength 3 in each of five sessions, 6.7 together."""
    F = np.ones((1, 1, 1))
    assert log_bayes(np.array([[15.0]]), 5 * F, F)[0] > -np.log(ALPHA) + 10


def test_the_evidence_is_the_integral_over_the_amplitude() -> None:
    """By the trapezium rule: one amplitude in all sessions, and one in each."""
    F, U = np.array([0.8, 2.0, 1.1]), np.array([1.9, 3.1, -0.4])
    a = np.linspace(-60, 60, 240_001)
    likelihood = np.exp(a[:, None] * U - 0.5 * a[:, None] ** 2 * F)

    def normal(variance: float) -> np.ndarray:
        return np.exp(-0.5 * a**2 / variance) / np.sqrt(2 * np.pi * variance)

    same = np.mean([np.trapezoid(likelihood.prod(axis=1) * normal(k**2 / F[0]), a) for k in STRENGTHS])
    found = log_bayes(U.sum()[None, None], F.sum()[None, None, None], F[:1, None, None])[0]
    assert found == pytest.approx(np.log(same), rel=1e-4)
    each = [[np.trapezoid(likelihood[:, s] * normal(t**2 / F[s]), a) for s in range(3)] for t in SPREADS]
    varying = log_varying(np.array([(U**2 / F).sum()]), np.array([3]))[0]
    assert varying == pytest.approx(np.log(np.mean(np.prod(each, axis=1))), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("spread", [0.0, 1.0, 4.0])
def test_two_sigma_hold_the_amplitude(spread: float) -> None:
    """93 to 97 % of 300 groups of twelve sessions, widened by some two standard errors of that share; without a spread
    a little more, since nobody knows that there is none."""
    rng = np.random.default_rng(int(spread) + 101)
    inside = []
    for _ in range(300):
        F = rng.uniform(0.3, 3.0, 12)
        own = 2.0 + spread * rng.standard_normal(12)
        mean = mean_of((F * own + np.sqrt(F) * rng.standard_normal(12))[:, None], F[:, None, None])
        inside.append(abs(mean.value[0] - 2.0) < 2 * mean.sigma[0])
    assert 0.905 < np.mean(inside) < 0.99


def test_the_mean_is_weighed_over_spreads_that_a_half_cauchy_makes_likely() -> None:
    """Gelman 2006: τ has the prior 1/(1 + τ²) in one session's sigma; integrated here on a fine grid of its own."""
    own = np.array([0.0, 1.5, 4.0])  # of sigma 1 each: at a given τ the mean is theirs, ± √((1 + τ²)/3)
    mean = mean_of(own[:, None], np.ones((3, 1, 1)))
    tau2 = (0.002 * np.arange(50_000)) ** 2
    variance = 1 + tau2
    likelihood = variance**-1.0 * np.exp(-((own - own.mean()) ** 2).sum() / (2 * variance))  # restricted: n − 1 = 2
    share = likelihood / (1 + tau2)
    expected = np.sqrt((share * variance / 3).sum() / share.sum())
    assert (mean.value[0], mean.sigma[0]) == pytest.approx((own.mean(), expected), rel=0.02)


def test_sessions_that_differ_are_told_from_sessions_that_do_not() -> None:
    F = np.ones((10, 1, 1))
    alike = mean_of(np.full((10, 1), 3.0) + 0.5 * (-1.0) ** np.arange(10)[:, None], F)
    apart = mean_of(np.full((10, 1), 3.0) + 6.0 * (-1.0) ** np.arange(10)[:, None], F)
    assert (alike.spread, alike.cochran > 0.5) == (0.0, True)
    assert apart.spread == pytest.approx(6.0, rel=0.2)
    assert apart.cochran < 1e-6
