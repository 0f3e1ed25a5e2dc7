"""The likelihoods of a history, against the joint normal distribution written down without whitening."""

import numpy as np
import pytest
from scipy import stats
from scipy.special import logsumexp

from estimator.health.fits import PARTS, WALKS, Readings, fits
from estimator.health.shapes import Kind, shapes
from estimator.session import Array
from tests.estimator.health.histories import dates, measured, readings, walk

DIFFUSE = 30.0
"""One sigma of the level, T, that stands for flat."""


def one_history() -> Readings:
    rng = np.random.default_rng(1)
    t = dates(rng, 7)
    return readings(measured(rng, t, walk(rng, t, 0.3) + 0.2 * t))


def joint(of: Readings, q: float, column: Array, size: float) -> Array:
    """(n, n) covariance of the readings."""
    walked = q**2 * np.minimum.outer(of.time, of.time)
    return walked + np.diag(of.sigma[:, 0] ** 2) + DIFFUSE**2 + size**2 * np.outer(column, column)


def place_of(kind: Kind, size: float) -> int:
    """Place of a size among the sizes of its kind."""
    return [own for of, own in PARTS if of is kind].index(size)


def test_ratios_are_those_of_the_joint_distribution() -> None:
    of = one_history()
    family = shapes(of.time)
    found = fits(of, family)
    for q, ratios in zip(WALKS, found.log_ratios(Kind.JUMP)[place_of(Kind.JUMP, 0.6)], strict=True):
        for place, ratio in zip(np.flatnonzero(family.kind == Kind.JUMP), ratios, strict=True):
            column = family.columns[:, place]
            exact = [stats.multivariate_normal(np.zeros(7), joint(of, q, column, s)).logpdf(of.value[:, 0])
                     for s in (0.6, 0.0)]  # fmt: skip
            assert ratio == pytest.approx(exact[0] - exact[1], abs=1e-3)


def test_strengths_of_the_walk_compare_as_in_the_joint_distribution() -> None:
    of = one_history()
    found = fits(of, shapes(of.time)).log_likelihood[:, 0]
    exact = [stats.multivariate_normal(np.zeros(7), joint(of, q, of.time, 0)).logpdf(of.value[:, 0]) for q in WALKS]
    assert np.diff(found) == pytest.approx(np.diff(exact), abs=1e-3)


@pytest.mark.parametrize("q", [0.0, 0.3])
def test_the_last_level_is_that_of_the_joint_distribution(q: float) -> None:
    of = one_history()
    found = fits(of, shapes(of.time), np.array([q]))
    prior = joint(of, q, of.time, 0) - np.diag(of.sigma[:, 0] ** 2)
    gain = prior @ np.linalg.inv(prior + np.diag(of.sigma[:, 0] ** 2))
    assert found.gain[0, 0] @ of.value[:, 0] == pytest.approx((gain @ of.value[:, 0])[-1], abs=1e-4)
    assert found.variance[0, 0] == pytest.approx((prior - gain @ prior)[-1, -1], rel=1e-3)


def test_a_drift_begins_anywhere_within_its_gap() -> None:
    """The mean over its beginnings on a fine grid; the middle of the gap alone has e^−9 of it."""
    t = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    one = readings(measured(np.random.default_rng(1), t, 0.8 * np.maximum(t - 1.45, 0.0), 0.03))
    family = shapes(t)
    ratios = fits(one, family, np.zeros(1)).log_ratios(Kind.LATE)[place_of(Kind.LATE, 0.9), 0]
    own = ratios[family.gap[family.kind == Kind.LATE] == 3]

    def likelihood(onset: float, size: float = 0.9) -> float:
        of = stats.multivariate_normal(np.zeros(5), joint(one, 0.0, np.maximum(t - onset, 0.0), size))
        return float(of.logpdf(one.value[:, 0]))

    exact = logsumexp([likelihood(onset) for onset in np.linspace(1.0, 1.5, 101)]) - np.log(101) - likelihood(9.0)
    assert logsumexp(own) - np.log(len(own)) == pytest.approx(exact, abs=1.0)
    assert likelihood(1.25) - likelihood(9.0) < exact - 9
