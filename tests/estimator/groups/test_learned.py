"""Structure that sessions share and no cause explains is learned as an equation, and nothing is learned of noise."""

import numpy as np
import pytest

from estimator import diagnose_group
from estimator.groups.joint_fit import predictive
from tests.blind.world import Effect
from tests.estimator.groups.cases import measured, worlds


def third_harmonic(size: float) -> list[Effect]:
    """k·sin(3β + 0.5) on A2."""
    return [Effect("third-harmonic", (size,), (1,), (0.5,))]


@pytest.fixture(scope="module")
def sessions():
    """Nine sessions with a wave that no cause has."""
    return [measured(w, third_harmonic(2e-4), 40 + k) for k, w in enumerate(worlds(9))]


def test_the_group_is_unexplained_and_shows_the_term(sessions) -> None:
    found = diagnose_group(sessions)
    assert found.unexplained
    assert found.findings == ()
    (term,) = found.terms
    assert term.words == ("sin 3β", "cos 3β")
    off = (np.array(term.amplitude) - 2e-4 * np.array([np.cos(0.5), np.sin(0.5)])) / term.sigma
    assert np.abs(off).max() < 3.5
    assert "sin 3β" in term.equation
    assert term.gain > 0
    before, after = (np.abs(side) for side in (term.picture.before, term.picture.after))
    assert after.mean() < before.mean()


def test_nothing_is_learned_that_the_sessions_left_out_lose_by() -> None:
    """In every third session, which take no part in the fit, the wave is reversed."""
    whole = [measured(w, third_harmonic(2e-4 * (-1) ** (k % 3 == 2)), 40 + k) for k, w in enumerate(worlds(9))]
    assert diagnose_group(whole).terms == ()


def test_the_predictive_gain_is_the_ratio_of_two_normal_densities() -> None:
    """U ~ N(F·a, F + F·V·F) against N(0, F), one amplitude."""
    a, V, U, F = 0.7, 0.3, 2.1, 1.9
    wide = F + F * V * F
    ratio = -0.5 * (U - F * a) ** 2 / wide + 0.5 * U**2 / F - 0.5 * np.log(wide / F)
    found = predictive(np.array([a]), np.array([[V]]), np.array([U]), np.array([[F]]))
    assert found == pytest.approx(ratio)
