"""Rotation from samples of the rate: a closed form, and the order of the error."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimator.hand_turns.integrate import attitude, chained, rotation_vectors


def coning(time, half_angle, frequency):
    """Attitude and rate of an axis that runs round a cone (Savage 1998): C = exp(z·wt)·exp(y·a)·exp(−z·wt)."""
    w, a = 2 * np.pi * frequency, half_angle
    turned = Rotation.from_euler("ZYZ", np.column_stack([w * time, np.full_like(time, a), -w * time]))
    rate = w * np.column_stack(
        [-np.sin(a) * np.cos(w * time), -np.sin(a) * np.sin(w * time), np.full_like(time, np.cos(a) - 1)]
    )
    return turned, rate


def drift(samples_a_turn, turns=8):
    """Attitude error, rad, after whole turns about a cone of 0.1 rad once a second; the ends, where the rate is held,
    are left out."""
    time = np.arange(-1, turns * samples_a_turn + 2) / samples_a_turn
    truth, rate = coning(time, 0.1, 1.0)
    C = Rotation.from_matrix(attitude(rate, 1 / samples_a_turn))
    return (truth[1].inv() * truth[-2]).inv() * C[1].inv() * C[-2]


def test_the_rate_of_the_cone_is_that_of_its_attitude():
    time = np.array([0.3, 0.3 + 1e-6])
    truth, rate = coning(time, 0.1, 1.0)
    assert (truth[0].inv() * truth[1]).as_rotvec() / 1e-6 == pytest.approx(rate.mean(axis=0), abs=1e-6)


def test_a_hand_that_cones_once_a_second_is_followed_to_a_microradian():
    assert drift(100).magnitude() < 1e-6


def test_the_error_falls_with_the_fourth_power_of_the_step():
    assert drift(20).magnitude() / drift(40).magnitude() == pytest.approx(16, rel=0.3)


def test_without_the_coning_term_the_error_is_a_thousand_times_larger():
    time = np.arange(801) / 100
    truth, rate = coning(time, 0.1, 1.0)
    plain = Rotation.from_quat(chained(0.005 * (rate[1:] + rate[:-1])))
    error = (truth[0].inv() * truth[-1]).inv() * plain[-1]
    assert error.magnitude() > 1000 * drift(100).magnitude()


@pytest.mark.parametrize("n", [1, 2, 3, 16, 17, 1000])
def test_the_chain_is_the_product_of_its_steps(n):
    vectors = np.random.default_rng(n).normal(scale=0.1, size=(n, 3))
    product = Rotation.identity()
    for vector in vectors:
        product = product * Rotation.from_rotvec(vector)
    chain = Rotation.from_quat(chained(vectors))
    assert len(chain) == n + 1
    assert (product.inv() * chain[-1]).magnitude() < 1e-12


def test_steps_start_and_end_with_the_rate_held():
    assert rotation_vectors(np.ones((5, 3)), 0.1) == pytest.approx(np.full((4, 3), 0.1))
