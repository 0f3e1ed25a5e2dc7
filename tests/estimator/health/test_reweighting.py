"""Weight of a session by its error, given all that the history may be."""

import numpy as np
import pytest

from benchmarks.tails.reweighting import _squares, reweighted
from estimator.health.fits import PART_KINDS, WALKS, Readings, fits
from estimator.health.pooled import Prior
from estimator.health.posterior import hypotheses_of
from estimator.health.shapes import Kind, shapes
from estimator.session import Array

NEVER = np.zeros(len(PART_KINDS))
STILL = np.where(WALKS == 0, 1.0, 1e-300)


def readings(value: Array, sigma: Array) -> Readings:
    n = len(value)
    return Readings(np.arange(float(n)), value[:, None], sigma[:, None], np.ones((n, 1)), np.ones(1))


def test_squared_errors_beside_a_jump_are_those_of_the_joint_normal_law() -> None:
    """z₂ − z₁ = a + e₂ − e₁ and nothing else is known: e₂ is normal given the difference."""
    given = readings(np.array([0.0, 0.5]), np.array([0.1, 0.2]))
    family = shapes(given.time)
    jumps = np.where((PART_KINDS == Kind.JUMP) & (np.arange(len(PART_KINDS)) == 2), 1e18, 0.0)
    found = fits(given, family)
    square = _squares(found, given, hypotheses_of(found, Prior(STILL, STILL, jumps, NEVER)))
    total = 0.6**2 + 0.1**2 + 0.2**2
    assert square[:, 0] == pytest.approx([s**2 - s**4 / total + (s**2 * 0.5 / total) ** 2 for s in (0.1, 0.2)])


def test_a_bad_day_counts_for_less_and_the_others_for_more() -> None:
    given = readings(np.array([0.0, 0.0, 0.6, 0.0, 0.0]), np.full(5, 0.1))
    worth = reweighted(
        given, shapes(given.time), Prior(STILL, STILL, NEVER, NEVER, tails=np.eye(4)[2]), is_missing=False
    )
    assert worth.sigma[2, 0] > 0.2
    assert (np.delete(worth.sigma, 2) < 0.1).all()
