"""Accuracy in closed form: what the propagated covariances must agree with (to first order, c = 0).

Source: the propagation of reading noise s and of a raise ε = θ_x + δα through (22), (23). The paper's printed (29) has
(1 − r2²)·tan²α where the square (1 − r2²)²·tan²α belongs and no 1/K² in its noise term; the noise term of its (30)
goes negative as r2² → 1, and its θ_y term belongs to an estimator that does not join the two runs.
"""

from dataclasses import replace

import numpy as np
import pytest

from estimator import Calibration, StandErrors, calibrate
from estimator.parameters import nominal
from estimator.session import Array
from estimator.simulate import simulate
from tests.builders import ARCSEC, GRAVITY
from tests.estimator.calibration.cases import STAND, accelerometers, block

SHARES = [0.0, 0.2, 1 / 3, 0.6, 0.95]
"""e2², the share of the input axis along the head."""
S, EPSILON, ALPHA, N = 2.5e-5, 20 * ARCSEC, np.radians(40.0), 24


def accuracy(share: float, sigma: StandErrors, alpha: float = ALPHA) -> tuple[Calibration, Array, Array]:
    """Calibration of sensors about the head with e2² = share; relative scale and axis variances, (m,) each."""
    around = 2 * np.pi * np.arange(6) / 6 + 0.1
    side = np.sqrt(1 - share)
    axes = np.column_stack([side * np.cos(around), np.full(6, np.sqrt(share)), side * np.sin(around)])
    sensors = tuple(replace(s, nominal_axis=axes[i], bias_repeatability=0.0) for i, s in enumerate(accelerometers()))
    schedule = block(sensors, N, mounting=np.eye(3))
    schedule = replace(schedule, stand=replace(STAND, alpha=alpha, sigma=sigma))
    session = simulate(schedule, nominal(sensors), np.random.default_rng(0), noise=0.12 * S)
    result = calibrate(session)
    standing = result.repeatability if sigma == StandErrors() else result.covariance - result.repeatability
    own = np.diagonal(standing).reshape(6, 5)
    return result, own[:, 0] / 0.12**2, own[:, 3] + own[:, 4]


@pytest.mark.parametrize("share", SHARES)
def test_reading_noise(share: float) -> None:
    result, scale, axis = accuracy(share, StandErrors())
    sin2, cos2, unit = np.sin(ALPHA) ** 2, np.cos(ALPHA) ** 2, S**2 / (N * GRAVITY**2)
    assert scale == pytest.approx(unit * ((1 - share) / cos2 + share / (2 * sin2)), rel=1e-3)
    assert axis == pytest.approx(unit * ((1 + share) / cos2 + (1 - share) / (2 * sin2)), rel=1e-3)
    for i in range(6):
        C = result.covariance[5 * i : 5 * i + 5, 5 * i : 5 * i + 5]
        with_c_known = C[1, 1] - C[1, 2] ** 2 / C[2, 2]
        assert with_c_known == pytest.approx(S**2 / (2 * N), rel=1e-3)


@pytest.mark.parametrize("alpha_deg", [30.0, 40.0, 55.0])
@pytest.mark.parametrize("share", SHARES)
def test_raise_of_the_head(share: float, alpha_deg: float) -> None:
    alpha = np.radians(alpha_deg)
    _, scale, axis = accuracy(share, StandErrors(theta_x=EPSILON * 0.6, alpha=EPSILON * 0.8), alpha)
    tan, cot = np.tan(alpha), 1 / np.tan(alpha)
    assert np.allclose(scale, EPSILON**2 * (share * cot - (1 - share) * tan) ** 2, rtol=2e-3, atol=1e-14)
    assert np.allclose(axis, EPSILON**2 * share * (1 - share) * (tan + cot) ** 2, rtol=2e-3, atol=1e-14)


def test_the_raise_leaves_the_bias_alone() -> None:
    result, _, _ = accuracy(1 / 3, StandErrors(alpha=EPSILON))
    bias = np.diagonal(result.covariance - result.repeatability).reshape(6, 5)[:, 1]
    assert np.all(np.sqrt(np.abs(bias)) < 1e-3 * EPSILON * GRAVITY)


def test_levelling_across_the_head_leaves_scale_and_axis_alone() -> None:
    _, scale, axis = accuracy(1 / 3, StandErrors(theta_y=EPSILON))
    assert np.all(scale < 1e-4 * EPSILON**2)
    assert np.all(axis < 1e-4 * EPSILON**2)


def test_repeatability_stands_beside_a_stand_far_worse_than_the_readings() -> None:
    poor, perfect = (accuracy(1 / 3, StandErrors(alpha=e))[0] for e in (200 * EPSILON, 0.0))
    assert np.all(np.linalg.eigvalsh(poor.repeatability) > 0)
    assert np.allclose(np.diagonal(poor.repeatability), np.diagonal(perfect.repeatability), rtol=0.05)
