"""Prediction of turns that took no part in the fit, with lever arms and without them.

Every turn is held out once; of a single turn every fifth piece or so. The rest, with the stops, fits k, p, q and, for
sensors whose lever arm is named, c and d. Prediction is with full covariance, the lean that pieces of a turn share
included.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.alignment.lever_arms import FittedLeverArm, LeverArms
from estimator.alignment.pieces import Pieces
from estimator.alignment.turned import whitened
from estimator.least_squares import inverse as inverse_of
from estimator.session import Array

PARTS = (5, 4, 3, 2)
"""Folds that a single turn is cut into: five as the positions of a calibration are, or fewer, so that its start and its
stop are not held out together. They alone tell what acceleration adds."""
FOLDS = 10
"""Folds that many turns are put into."""


@dataclass(frozen=True)
class HeldOutPrediction:
    """Prediction errors over the pieces of all turns."""

    rms: float
    """m/s²."""
    chi2: float
    """Mean χ² of a piece."""
    log_score: float
    """Mean log density of a piece, in units of its own sigma."""
    rms_by_sensor: dict[str, float]
    """m/s², by the sensor's name."""


def held_out(arms: LeverArms) -> str:
    """The held-out parts, in words."""
    return "turns" if arms.pieces.turn.max() > 0 else "parts of the turn"


def prediction(arms: LeverArms, *, named: bool) -> HeldOutPrediction:
    """Predicts every turn by a fit to the others; ``named``: with the named lever arms in the model."""
    parts = arms.pieces
    scores, rms = [], {}
    for arm in arms.estimates:
        fold_scores = [_scores(parts, arm, arms.lean, fold, named=named) for fold in _folds(parts)]
        rms[arm.sensor.name] = root_mean_square(np.concatenate([errors for errors, _, _ in fold_scores]))
        scores += fold_scores
    errors, squares, logs = (np.concatenate(column) for column in zip(*scores, strict=True))
    return HeldOutPrediction(root_mean_square(errors), float(squares.mean()), float(logs.mean()), rms)


def root_mean_square(errors: Array) -> float:
    """Root mean square of errors (n,), m/s²."""
    return float(np.sqrt(np.mean(errors**2)))


def _folds(parts: Pieces) -> list[NDArray[np.bool_]]:
    """(N,) bool of the pieces that each fold holds out."""
    if parts.turn.max() > 0:
        fold = np.where(parts.turn >= 0, parts.turn % FOLDS, -1)
        return [fold == number for number in range(fold.max() + 1)]
    moving = parts.turn >= 0
    count = next((n for n in PARTS if (moving.sum() - 1) % n), PARTS[-1])
    place = np.cumsum(moving) % count
    folds = [moving & (place == number) for number in range(count)]
    return [fold for fold in folds if fold.any()]


def _scores(
    parts: Pieces, arm: FittedLeverArm, lean: float, fold: NDArray[np.bool_], *, named: bool
) -> tuple[Array, Array, Array]:
    """Errors (n,), m/s², of held-out pieces, their whitened squares and log densities, without unit."""
    i, known = arm.response.sensor, ~fold
    root = whitened(parts, i, lean * float(np.hypot(*arm.sensor.nominal_axis[:2])), arm.response.noise_ratio).root
    V, z = root @ root.T, parts.values[:, i]
    X = np.column_stack([parts.level, parts.levers]) if named and arm.named else parts.level
    inverse = np.linalg.inv(V[np.ix_(known, known)])
    information = X[known].T @ inverse @ X[known]
    C = inverse_of(information, 1e-15)
    beta = C @ X[known].T @ inverse @ z[known]
    gain = V[np.ix_(fold, known)] @ inverse
    rest = X[fold] - gain @ X[known]
    errors = z[fold] - gain @ z[known] - rest @ beta
    S = V[np.ix_(fold, fold)] - gain @ V[np.ix_(known, fold)] + rest @ C @ rest.T
    L = np.linalg.cholesky(S)
    white = np.linalg.solve(L, errors)
    deviation = np.sqrt(parts.density[i] / parts.time[fold])
    return errors, white**2, -0.5 * white**2 - np.log(np.diag(L) / deviation) - 0.5 * np.log(2 * np.pi)
