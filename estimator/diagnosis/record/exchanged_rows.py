"""Rows whose readings are exchanged.

Screened linearly: exchanging rows j and k back changes the residuals by the difference of the two rows' simulated
readings. The best few are tried by fitting the corrected record. Where noise is estimated from the residuals
themselves, what counts is how far the exchange brings them down.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from estimator.causes.contract import RecordCorrection
from estimator.causes.record import exchange_rows
from estimator.diagnosis.record.record_error import BETTER, RecordAttempt, RecordError
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.least_squares import FLAT, orthonormal
from estimator.session import Array

GROSS = 20.0
"""χ² per degree of freedom beyond which exchanged rows are looked for: two rows of different positions differ by far
more than that, and causes of the catalogue seldom reach it."""

PROMISING = 2.0
"""Factor by which the best exchange must bring χ² down by the linear screen."""

CONVINCING = 4.0
"""Factor by which it must bring χ² down when the record is fitted anew."""

FITTED = 12
"""Exchanges that are fitted: the linear screen ranks the true one among the first."""


def exchanged_rows(baseline: Baseline, known: Sequence[RecordCorrection]) -> RecordError | None:
    """Two rows whose readings are exchanged, or None."""
    chi2 = weighted_square(baseline)
    cause = next((c for c in known if c.of_rows), None)
    if cause is None or (not baseline.unstated.any() and chi2 < GROSS * baseline.residual.size):
        return None
    pairs = list(combinations(range(len(baseline.residual)), 2))
    gains = exchange_gains(baseline, pairs)
    if gains.max() < chi2 / PROMISING:
        return None
    tried = [exchanged_back(baseline, cause, pairs[int(k)], len(pairs)) for k in np.argsort(-gains)[:FITTED]]
    tried.sort(key=lambda t: -t[0].log_evidence)
    best, after = tried[0]
    if best.log_evidence < BETTER or after > chi2 / CONVINCING:
        return None
    return RecordError(tuple(attempt for attempt, _ in tried))


def exchanged_back(
    baseline: Baseline, cause: RecordCorrection, rows: tuple[int, int], alternatives: int
) -> tuple[RecordAttempt, float]:
    """One exchange, among so many ways, with the χ² that the corrected record leaves under the same noise."""
    before, freedom = weighted_square(baseline), baseline.residual.size
    right = exchange_rows(baseline.session, *rows)
    after = float((baseline_of(right).residual ** 2 / baseline.variance).sum())
    blind = bool(baseline.unstated.any())
    gained = 0.5 * freedom * np.log(before / after) if blind else 0.5 * (before - after)
    return RecordAttempt(cause, rows, right, float(gained - np.log(alternatives))), after


def weighted_square(baseline: Baseline) -> float:
    """χ² of the readings under their independent noise alone."""
    return float((baseline.residual**2 / baseline.variance).sum())


def exchange_gains(baseline: Baseline, pairs: Sequence[tuple[int, int]]) -> Array:
    """(E,) χ², dimensionless, that each of E exchanges would take away, the baseline refitted linearly."""
    R, m = baseline.residual.shape
    weight = 1 / np.sqrt(baseline.variance)
    measured = baseline.residual + baseline.setting.a
    gains, numbers = np.zeros(len(pairs)), np.arange(len(pairs))
    j, k = np.array(pairs).T
    for i in range(m):
        design = baseline.design[:, i, :] * weight[:, i, None]
        basis = orthonormal(design, FLAT)
        jump = measured[k, i] - measured[j, i]
        change = np.zeros((len(pairs), R))
        change[numbers, j], change[numbers, k] = jump * weight[j, i], -jump * weight[k, i]
        change -= (change @ basis) @ basis.T
        gains -= 2 * change @ (baseline.residual[:, i] * weight[:, i]) + (change**2).sum(axis=1)
    return gains
