"""What naming the causes is worth: prediction of readings that took no part in the fit.

Positions are held out fold by fold. The rest of the rows fit the model, without and with the signatures, and predict
the held-out rows with full predictive covariance; all in the whitened frame, where rows are independent. *Before* is
the baseline of the record as it came, with the noise as stated; *after* holds the named causes, excess noise among
them, the record put right. Both log scores are densities of the same numbers, readings in their stated sigmas: what a
larger sigma costs is counted.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.diagnosis.explanation.earlier_sessions import LN_2PI, transfer
from estimator.diagnosis.explanation.extended_model import Amplitudes
from estimator.diagnosis.residuals.baseline import Baseline, block_columns
from estimator.diagnosis.residuals.whitened import Whitener
from estimator.diagnosis.results import Gain, Score
from estimator.diagnosis.selection.search_state import SearchState
from estimator.session import Array

FOLDS = 6
"""Parts of the positions, each held out once: every sixth row, so that five sixths fit the model and every part
reaches around the circle."""

FLAT = 1e-8
"""Prior information of a parameter's unit column: none to speak of, yet what is not observed stays put."""


def gain(state: SearchState, given: Baseline | None, fitted: Amplitudes, new: Sequence[bool | None]) -> Gain:
    """Scores of held-out positions and of an earlier session, before and after.

    ``given``: of the record as it came, where it had to be put right; ``new``: of every finding, whether it came since
    the history.
    """
    columns = [f.best.shape.columns for f in state.found if not f.best.cause.between]
    given = given or as_stated(state)
    before, after = score(given, []), score(state.baseline, columns)
    dearer = volume(state.baseline) - volume(given)
    after = replace(after, log_score=after.log_score + dearer / float(counted(given).sum()))
    return Gain(before, after, "positions", transfer(state, fitted, new))


def as_stated(state: SearchState) -> Baseline:
    """The baseline with the noise that the file states."""
    variance = state.baseline.variance.copy()
    for scatter in state.scatter:
        variance[:, scatter.sensor] /= scatter.ratio
    return replace(state.baseline, variance=variance)


def volume(baseline: Baseline) -> float:
    """ln of the factor by which whitening scales volumes; directions of which nothing is known are integrated out."""
    weight = 1 / np.sqrt(baseline.variance)
    unknown = np.isinf(baseline.row_sigma)
    scaled = baseline.row * weight[..., None] * np.where(unknown, 1.0, baseline.row_sigma)[:, None, :]
    size = np.linalg.svd(scaled, compute_uv=False)
    share = np.where(unknown.any(axis=1, keepdims=True), np.where(size > 0, size, 1.0), np.sqrt(1 + size**2))
    return float(np.log(weight).sum() - np.log(share).sum())


def counted(baseline: Baseline) -> Array:
    """(R,) number of readings of every row less the directions that they serve to estimate."""
    return np.asarray(baseline.residual.shape[1] - Whitener.of(baseline).projected_out.sum(axis=1))


def score(baseline: Baseline, signatures: Sequence[Array]) -> Score:
    """Predict every row from the folds that do not hold it; ``signatures`` (R, m, q), m/s² (rad/s), in the model."""
    R, m = baseline.residual.shape
    whiten, number = Whitener.of(baseline), counted(baseline)
    parts = [block_columns(baseline.design), baseline.constant, *signatures]
    design = whiten(np.concatenate(parts, axis=-1)).reshape(R, m, -1)
    data = whiten(baseline.residual[..., None]).reshape(R, m)
    size = np.maximum(np.linalg.norm(design, axis=(0, 1)), 1e-300)
    design = design / size
    whole = np.tensordot(design, design, axes=([0, 1], [0, 1])) + np.diag(priors(baseline, size))
    errors, logs, squares = np.zeros((R, m)), 0.0, 0.0
    for fold in range(FOLDS):
        rows = np.arange(R) % FOLDS == fold
        if not rows.any():
            continue
        own, rest = (design[r].reshape(-1, design.shape[-1]) for r in (rows, ~rows))
        inverse = np.linalg.pinv(whole - own.T @ own, hermitian=True)
        error = data[rows].reshape(-1) - own @ (inverse @ (rest.T @ data[~rows].reshape(-1)))
        covariance = np.eye(len(own)) + own @ inverse @ own.T
        square = float(error @ np.linalg.solve(covariance, error))
        squares += square
        logs -= 0.5 * (square + float(np.linalg.slogdet(covariance)[1]) + float(number[rows].sum()) * LN_2PI)
        errors[rows] = error.reshape(-1, m)
    return Score(
        rms=float(np.sqrt(np.mean((errors / whiten.weight) ** 2))),
        chi2_per_dof=squares / float(number.sum()),
        log_score=logs / float(number.sum()),
    )


def priors(baseline: Baseline, size: Array) -> Array:
    """(p,) prior information of every unit column, dimensionless, from the columns' norms ``size`` (p,).

    Of the constant nuisances theirs, of the rest next to none.
    """
    prior = np.full(len(size), FLAT)
    P, k = 5 * baseline.residual.shape[1], len(baseline.constant_sigma)
    prior[P : P + k] = (baseline.constant_sigma * size[P : P + k]) ** -2.0
    return prior
