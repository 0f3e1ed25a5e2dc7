"""The contract of `estimator.calibrate` for every calibrator, on every kind of session.

Statistical limits are 6σ for the third of a million errors of all cases together, 0.1 % for tests on sums.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from estimator import Calibration, calibrate, calibrate_many
from estimator.session import Array
from tests.estimator.calibration.bound import bound
from tests.estimator.calibration.cases import CASES, Case, Trials, at_rows, estimates


@pytest.fixture(scope="module", params=CASES, ids=lambda case: case.name)
def case(request: pytest.FixtureRequest) -> Case:
    """Each in turn, with all its tests one after another: its trials are drawn once."""
    found: Case = request.param
    return found


@pytest.fixture(scope="module")
def trials(case: Case) -> Trials:
    """The Monte Carlo of the case."""
    return case.trials()


def whitened(found: Array, covariance: Array) -> Array:
    """(n,) normalised errors squared of (n, p) under one covariance (p, p) or each its own (n, p, p)."""
    sigma = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
    shape = covariance / (sigma[..., :, None] * sigma[..., None, :])
    scaled = (found / sigma)[..., None]
    return (scaled * (np.linalg.pinv(shape, rcond=1e-9, hermitian=True) @ scaled)).sum(axis=(-1, -2))


def rank(covariance: Array) -> int:
    """Number of directions in which a covariance (p, p) is not zero."""
    sigma = np.sqrt(np.diagonal(covariance))
    return int(np.linalg.matrix_rank(covariance / np.outer(sigma, sigma), rtol=1e-9, hermitian=True))


def test_truth_lies_within_the_stated_uncertainty(trials: Trials) -> None:
    sigma = np.sqrt(np.diagonal(trials.covariance, axis1=1, axis2=2))
    assert np.abs(trials.errors / sigma).max() < 6
    assert trials.converged


def test_monte_carlo_variance_reaches_the_cramer_rao_bound(case: Case, trials: Trials) -> None:
    least = bound(case)
    kept = trials.seen & np.isfinite(np.diagonal(least))
    found = trials.errors[:, kept[trials.seen]]
    least = least[np.ix_(kept, kept)]
    assert kept.any()
    assert whitened(found, least).mean() / kept.sum() == pytest.approx(1.0, abs=0.05)
    one_by_one = (found**2).mean(axis=0) / np.diagonal(least)
    assert np.all(np.abs(one_by_one - 1.0) < 5 * np.sqrt(2 / len(found)))


def test_stated_covariance_is_the_bound(case: Case, trials: Trials) -> None:
    least = np.diagonal(bound(case))[trials.seen]
    stated = np.diagonal(trials.covariance.mean(axis=0))
    kept = np.isfinite(least)
    assert np.allclose(stated[kept], least[kept], rtol=0.03)


def test_ninety_five_per_cent_intervals_hold(trials: Trials) -> None:
    sigma = np.sqrt(np.diagonal(trials.covariance, axis1=1, axis2=2))
    assert 0.93 <= np.mean(np.abs(trials.errors) < 1.96 * sigma) <= 0.97


def test_normalised_error_squared_is_chi_square(trials: Trials) -> None:
    total = whitened(trials.errors, trials.covariance).sum()
    freedom = rank(trials.covariance[0]) * len(trials.errors)
    assert stats.chi2.ppf(5e-4, freedom) < total < stats.chi2.ppf(1 - 5e-4, freedom)


def test_p_values_are_uniform(trials: Trials) -> None:
    assert stats.kstest(trials.p_values, "uniform").pvalue > 1e-3


def test_row_order_does_not_matter(case: Case) -> None:
    session = case.simulated(1)[0]
    order = np.random.default_rng(0).permutation(len(session.readings))
    plain, shuffled = calibrate(session), calibrate(at_rows(session, order))
    assert agree(plain.covariance, shuffled.covariance)
    assert np.abs(moved(plain, shuffled, np.eye(3))).max() < 1e-3
    assert np.allclose(plain.residuals.value[order], shuffled.residuals.value, rtol=0, atol=1e-7)


@pytest.mark.parametrize("turn", [np.eye(3)[[2, 0, 1]], Rotation.from_rotvec([0.4, -0.9, 2.0]).as_matrix()])
def test_naming_of_the_block_axes_does_not_matter(case: Case, turn: Array) -> None:
    session = case.simulated(1)[0]
    sensors = tuple(replace(s, nominal_axis=turn @ s.nominal_axis) for s in session.sensors)
    turned = calibrate(replace(session, sensors=sensors, mounting=turn @ session.mounting))
    assert np.abs(moved(calibrate(session), turned, turn)).max() < 1e-3


def test_one_by_one_is_the_same_as_together(case: Case) -> None:
    sessions = case.simulated(3, seed=9)
    for alone, together in zip(map(calibrate, sessions), calibrate_many(sessions), strict=True):
        assert np.abs(moved(alone, together, np.eye(3))).max() < 1e-3
        assert agree(alone.covariance, together.covariance)


def agree(a: Array, b: Array) -> bool:
    """Two covariances, what is not observed at the same places."""
    sigma = np.sqrt(np.diagonal(a))
    return bool(np.allclose(a / np.outer(sigma, sigma), b / np.outer(sigma, sigma), atol=1e-4, equal_nan=True))


def moved(plain: Calibration, other: Calibration, turn: Array) -> Array:
    """Differences of the observed parameters in the first one's sigmas, axes turned back first."""
    a, b = estimates(plain), estimates(other)
    b = replace(b, axis=b.axis @ turn)
    frames = np.stack([s.axis_tangents for s in plain.sensors])
    axis = ((b.axis - a.axis)[:, None] @ frames)[:, 0]
    d = np.column_stack([b.scale - a.scale, b.bias - a.bias, b.quadratic - a.quadratic, axis]).ravel()
    seen = np.isfinite(np.diagonal(plain.covariance))
    return d[seen] / np.sqrt(np.diagonal(plain.covariance)[seen])
