"""Sensors noisier than stated or, where nothing is stated, than usual of their kind."""

import numpy as np

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.priors import NOISE_RATIOS, NOISY, UNLIKE
from estimator.diagnosis.posterior.term import NOISE, ListedTerms, Term
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array


class NoisySensors(ListedTerms):
    """Every sensor's readings with a variance of their own beyond the stated one."""

    named = False

    def __init__(self, residuals: WhitenedResiduals) -> None:
        baseline = residuals.baseline
        self.layout, self.sigma = InputLayout.of(residuals), np.sqrt(baseline.variance)
        odds = np.where(baseline.unstated, UNLIKE, NOISY / self.layout.m)
        self.log_prior = np.log(odds / len(NOISE_RATIOS))
        super().__init__([(NOISE, (i,)) for i in range(self.layout.m)], [len(NOISE_RATIOS)] * self.layout.m)

    def weighed(self, info: InputInformation) -> Array:
        R, m = self.layout.R, self.layout.m
        A = info.A[: R * m, : R * m].reshape(R, m, R, m)[:, np.arange(m), :, np.arange(m)]
        sigma = self.sigma.T
        gram, along = sigma[:, :, None] * A * sigma[:, None, :], sigma * info.a[: R * m].reshape(R, m).T
        return (info.log_evidence_of(gram, along, np.sqrt(NOISE_RATIOS)) + self.log_prior[:, None]).ravel()

    def term(self, k: int) -> Term:
        i, level = divmod(k, len(NOISE_RATIOS))
        columns = self.layout.on_sensor(i, np.diag(self.sigma[:, i]))
        variance = np.full(self.layout.R, NOISE_RATIOS[level])
        return Term((NOISE, (i,)), columns, variance, float(self.log_prior[i]), named=False)
