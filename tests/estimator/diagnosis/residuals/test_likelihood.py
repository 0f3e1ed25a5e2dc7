"""The restricted likelihood of a session under two noises."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import block_diag, null_space
from scipy.stats import multivariate_normal

from estimator.diagnosis.residuals.baseline import Baseline, block_columns
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.likelihood import log_likelihood_ratio
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from tests.estimator.diagnosis.small import measured


def by_definition(baseline: Baseline) -> float:
    """ln density of the contrasts of the readings that no parameter moves; constant nuisances as they are spread."""
    row = baseline.row * baseline.row_sigma[:, None, :]
    V = block_diag(*(np.diag(v) + h @ h.T for v, h in zip(baseline.variance, row, strict=True)))
    constant = baseline.constant.reshape(len(V), -1) * baseline.constant_sigma
    free = block_columns(baseline.design)
    contrasts = null_space((free / np.sqrt((free**2).sum(axis=(0, 1)))).reshape(len(V), -1).T)
    covariance = contrasts.T @ (V + constant @ constant.T) @ contrasts
    return float(multivariate_normal.logpdf(contrasts.T @ baseline.residual.ravel(), cov=covariance))


@pytest.mark.parametrize("factor", [0.01, 3.0, 100.0])
def test_it_is_the_density_of_what_no_parameter_moves(factor: float) -> None:
    before = baseline_of(measured(seed=3))
    after = replace(before, variance=before.variance * [1.0, factor, 1.0, 1.0])
    found = log_likelihood_ratio(WhitenedResiduals.of(after), WhitenedResiduals.of(before))
    assert found == pytest.approx(by_definition(after) - by_definition(before), rel=1e-5, abs=1e-3)
