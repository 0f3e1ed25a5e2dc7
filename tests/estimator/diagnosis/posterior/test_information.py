"""The evidence of terms, against integrals done by brute force."""

import numpy as np
import pytest
from scipy import integrate
from scipy.stats import multivariate_normal

from estimator.diagnosis.posterior.information import InputInformation
from estimator.session import Array

T = np.random.default_rng(1).standard_normal((9, 6))
Z = np.random.default_rng(2).standard_normal(9) * 1.7
W = np.random.default_rng(3).standard_normal((6, 2))


def known(*, scaled: bool = False) -> InputInformation:
    return InputInformation(T.T @ T, T.T @ Z, float(Z @ Z), 9.0, scaled)


def density(amplitude: Array, columns: Array) -> float:
    """p(z | amplitudes) over p(z | nothing)."""
    left = Z - T @ columns @ amplitude
    return float(np.exp(0.5 * (Z @ Z - left @ left)))


def test_one_amplitude_is_integrated_out() -> None:
    column, size = W[:, :1], 0.6

    def weighed(u: float) -> float:
        return density(np.array([u]), column) * np.exp(-0.5 * (u / size) ** 2) / (size * np.sqrt(2 * np.pi))

    brute, _ = integrate.quad(weighed, -8, 8)
    assert known().given(column, np.array([size**2]))[1] == pytest.approx(np.log(brute), abs=1e-8)


def test_two_amplitudes_about_a_mean_are_integrated_out() -> None:
    mean, variance = np.array([0.5, 0.0]), np.array([0.04, 0.5])

    def weighed(v: float, u: float) -> float:
        amplitude = np.array([u, v])
        return density(amplitude, W) * float(multivariate_normal.pdf(amplitude, mean, np.diag(variance)))

    brute, _ = integrate.dblquad(weighed, -1, 2, -5, 5)
    assert known().given(W, variance, mean)[1] == pytest.approx(np.log(brute), abs=1e-6)


def test_terms_one_after_another_are_the_same_as_together() -> None:
    first, second = (W[:, :1], np.array([0.3])), (W[:, 1:], np.array([2.0]))
    left, one = known().given(*first)
    _, other = left.given(*second)
    covariance = np.eye(9) + T @ W @ np.diag([0.3, 2.0]) @ W.T @ T.T
    whole = multivariate_normal.logpdf(Z, cov=covariance) - multivariate_normal.logpdf(Z, cov=np.eye(9))
    assert one + other == pytest.approx(whole, abs=1e-10)
    assert known().given(W, np.array([0.3, 2.0]))[1] == pytest.approx(whole, abs=1e-10)


@pytest.mark.parametrize("scaled", [False, True])
def test_many_terms_at_once_are_weighed_as_each_alone(*, scaled: bool) -> None:
    info, sizes = known(scaled=scaled), np.array([0.2, 1.0, 5.0])
    gram, along = (W.T @ info.A @ W)[None], (W.T @ info.a)[None]
    each = info.log_evidence_of(gram, along, sizes)[0]
    assert each == pytest.approx([info.given(W, np.full(2, size**2))[1] for size in sizes])


def test_an_unknown_scale_of_the_noise_is_integrated_out() -> None:
    column, size = W[:, :1], 0.6
    covariance = np.eye(9) + size**2 * T @ column @ column.T @ T.T

    def weighed(log_variance: float, square: float) -> float:
        return float(np.exp(-0.5 * square * np.exp(-log_variance) - 4.5 * log_variance))

    with_it, _ = integrate.quad(weighed, -8, 12, args=(float(Z @ np.linalg.solve(covariance, Z)),))
    without, _ = integrate.quad(weighed, -8, 12, args=(float(Z @ Z),))
    expected = np.log(with_it / without) - 0.5 * np.linalg.slogdet(covariance)[1]
    assert known(scaled=True).given(column, np.array([size**2]))[1] == pytest.approx(expected, abs=1e-4)
