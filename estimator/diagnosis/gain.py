"""What naming the causes is worth: prediction of readings that took no part in the fit.

Positions are held out fold by fold. The rest of the rows fit the model, without and with the signatures, and predict
the held-out rows with full predictive covariance; all in the whitened frame, where rows are independent.
"""

import numpy as np

from estimator.diagnosis.baseline import spread
from estimator.diagnosis.results import Gain, Score
from estimator.diagnosis.state import Search
from estimator.session import Array

FOLDS = 6


def gain(state: Search) -> Gain:
    """Scores of held-out positions before and after the findings."""
    columns = [f.best.shape.columns for f in state.found if not f.best.cause.between]
    return Gain(score(state, []), score(state, columns) if columns else score(state, []), "positions")


def score(state: Search, signatures: list[Array]) -> Score:
    """Predict every row from the folds that do not hold it."""
    baseline, evidence = state.baseline, state.evidence
    R, m = baseline.residual.shape
    k = len(baseline.constant_sigma)
    parts = [spread(baseline.design), baseline.constant, *signatures]
    design = evidence.whiten(np.concatenate(parts, axis=-1)).reshape(R, m, -1)
    data = evidence.whiten(baseline.residual[..., None]).reshape(R, m)
    scale = np.maximum(np.linalg.norm(design, axis=(0, 1)), 1e-300)
    prior = np.full(design.shape[-1], 1e-8)
    prior[5 * m : 5 * m + k] = (baseline.constant_sigma * scale[5 * m : 5 * m + k]) ** -2.0
    design = design / scale
    whole = np.einsum("rmi,rmj->ij", design, design) + np.diag(prior)
    errors, logs, squares = np.zeros((R, m)), [], []
    for fold in range(FOLDS):
        rows = np.arange(R) % FOLDS == fold
        if not rows.any():
            continue
        own = design[rows].reshape(-1, design.shape[-1])
        inverse = np.linalg.pinv(whole - own.T @ own, hermitian=True)
        rest = design[~rows].reshape(-1, design.shape[-1])
        predicted = own @ (inverse @ (rest.T @ data[~rows].reshape(-1)))
        left = data[rows].reshape(-1) - predicted
        covariance = np.eye(len(own)) + own @ inverse @ own.T
        _, logdet = np.linalg.slogdet(covariance)
        square = float(left @ np.linalg.solve(covariance, left))
        squares.append(square)
        logs.append(-0.5 * (square + logdet + len(left) * np.log(2 * np.pi)))
        errors[rows] = left.reshape(-1, m)
    at_input = errors / evidence.whiten.weight
    return Score(
        rms=float(np.sqrt(np.mean(at_input**2))),
        chi2_per_dof=float(sum(squares) / data.size),
        log_score=float(sum(logs) / data.size),
    )
