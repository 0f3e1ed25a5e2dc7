"""Tails of errors: learned from a type's own histories, and an alarm is as rare as stated although errors have them."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.detection import detect
from estimator.health.error_laws import FREEDOMS, drawn, log_density
from estimator.health.fits import Readings, fits
from estimator.health.pooled import Evidence, learn
from estimator.health.shapes import shapes
from estimator.health.tails import log_tails
from estimator.session import Array

SIGMA = 0.1


def history(errors: Array, moved: Array | float = 0.0, law: int = 0) -> Readings:
    """Half a year apart; ``law`` the place of what errors are taken to follow."""
    n = len(errors)
    value = (SIGMA * errors + moved)[:, None]
    sigma, tails = np.full((n, 1), SIGMA), np.eye(len(FREEDOMS))[law]
    return Readings(0.5 * np.arange(n), value, sigma, np.ones((n, 1)), np.ones(1), tails)


def told(of: Readings) -> Evidence:
    found = fits(of, shapes(of.time))
    logs = found.log_evidence()
    return Evidence(found.span, logs, log_tails(of, found.family, logs))


def p_value(of: Readings) -> float:
    n = len(of.time)
    return detect(of, 0.0, np.full(n, np.inf), np.full(n, np.nan), 0.0).p_value


@pytest.mark.parametrize("freedom", FREEDOMS)
def test_a_law_is_a_density_with_the_stated_standard_deviation(freedom: float) -> None:
    z = np.linspace(-2000, 2000, 2_000_001)
    density = np.exp(log_density(z, freedom))
    assert np.trapezoid(density, z) == pytest.approx(1, abs=1e-6)
    assert np.trapezoid(density * z**2, z) == pytest.approx(1, abs=2e-2)


def test_heavy_tails_are_learned_from_a_type_and_normal_ones_too() -> None:
    rng = np.random.default_rng(1)
    heavy = learn([told(history(drawn(4.0, (10,), rng))) for _ in range(60)])
    normal = learn([told(history(rng.standard_normal(10))) for _ in range(60)])
    assert heavy.tails[2:].sum() > 0.9
    assert normal.tails[0] > 0.9


@pytest.mark.parametrize("moved", [np.linspace(0.0, 3.0, 10), np.cumsum(np.tile([0.5, -0.3], 5))])
def test_what_moves_says_nothing_of_tails(moved: Array) -> None:
    assert np.ptp(told(history(np.random.default_rng(2).standard_normal(10), moved)).log_tails) < 0.1


@pytest.mark.slow
def test_of_heavy_tails_alarms_are_as_rare_as_stated() -> None:
    rng, runs = np.random.default_rng(3), 400
    errors = [drawn(3.5, (8,), rng) for _ in range(runs)]
    known, ignored = (np.array([p_value(history(e, law=law)) for e in errors]) for law in (3, 0))
    assert np.sum(known < 0.01) <= stats.binom.isf(1e-2, runs, 0.01)
    assert np.sum(ignored < 0.01) > stats.binom.isf(1e-2, runs, 0.01)


def test_a_jump_of_many_sigmas_is_found_in_spite_of_tails() -> None:
    errors = drawn(5.0, (8,), np.random.default_rng(4))
    assert p_value(history(errors, 0.8 * (np.arange(8) >= 5), law=2)) < 1e-3
