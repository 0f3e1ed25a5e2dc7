"""Cross-validation: prediction of rows that took no part in the fit.

Rows are held out fold by fold. The rest fit the baseline, the constant nuisances and the effects in the model, and
predict the rows held out with full predictive covariance; all in the whitened frame, where rows are independent.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.content import once
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.session import Array

FOLDS = 6
"""Parts of the positions, each held out once: every sixth row, so that five sixths fit the model and every part
reaches around the circle."""

FLAT = 1e-8
"""Prior information of a parameter's unit column: none to speak of, yet what is not observed stays put."""

LN_2PI = float(np.log(2 * np.pi))


@dataclass(frozen=True, eq=False)
class Prediction:
    """Every row predicted from the folds that do not hold it. R rows, m sensors."""

    error: Array
    """(R, m) at the input, m/s² (rad/s)."""
    square: float
    """χ² of the errors under their predictive covariance."""
    volume: float
    """ln determinant of that covariance."""
    count: float
    """Number of readings, less the directions that they serve to estimate."""

    @property
    def log_score(self) -> float:
        """Sum of the log predictive densities of whitened readings, their noise as it was taken."""
        return -0.5 * (self.square + self.volume + self.count * LN_2PI)


def row_redundancy(baseline: Baseline) -> Array:
    """(R,) number of readings of every row less the directions that they serve to estimate."""
    return np.asarray(baseline.residual.shape[1] - baseline.whiten.projected_out.sum(axis=1))


def fold_of(rows: int) -> Array:
    """(R,) the fold that holds each of so many rows."""
    return np.arange(rows) % FOLDS


@once
def predicted_without_effects(baseline: Baseline) -> Prediction:
    """Every row predicted with no effect in the model."""
    return predicted(baseline, [()] * FOLDS)


def predicted(
    baseline: Baseline, effects: Sequence[Sequence[Array]], spreads: Sequence[Array] | None = None
) -> Prediction:
    """Predict every row; ``effects``: for every fold the columns (R, m, q), m/s² (rad/s), in the model there;
    ``spreads``: the standard deviations (Q,) of all their amplitudes beforehand, of which nothing is known without."""
    R, m = baseline.residual.shape
    whiten, number = baseline.whiten, row_redundancy(baseline)
    whitened = baseline.whitened_design[: R * m]
    data = whiten(baseline.residual[..., None]).reshape(R, m)
    errors, volume, squares = np.zeros((R, m)), 0.0, 0.0
    for fold, columns in enumerate(effects):
        rows = fold_of(R) == fold
        if not rows.any():
            continue
        design = np.concatenate([whitened, *map(whiten, columns)], axis=1).reshape(R, m, -1)
        size = np.maximum(np.linalg.norm(design, axis=(0, 1)), 1e-300)
        held, rest = (design[r].reshape(-1, len(size)) / size for r in (rows, ~rows))
        prior = priors(baseline, size)
        if spreads is not None and len(spreads[fold]):
            prior[-len(spreads[fold]) :] += (spreads[fold] * size[-len(spreads[fold]) :]) ** -2.0
        inverse = np.linalg.pinv(rest.T @ rest + np.diag(prior), hermitian=True)
        error = data[rows].reshape(-1) - held @ (inverse @ (rest.T @ data[~rows].reshape(-1)))
        covariance = np.eye(len(held)) + held @ inverse @ held.T
        squares += float(error @ np.linalg.solve(covariance, error))
        volume += float(np.linalg.slogdet(covariance)[1])
        errors[rows] = error.reshape(-1, m)
    return Prediction(errors / whiten.weight, squares, volume, float(number.sum()))


def priors(baseline: Baseline, size: Array) -> Array:
    """(p,) prior information of every unit column, dimensionless, from the columns' norms ``size`` (p,).

    Of the constant nuisances theirs, of the rest next to none.
    """
    prior = np.full(len(size), FLAT)
    P, k = 5 * baseline.residual.shape[1], len(baseline.constant_sigma)
    prior[P : P + k] = (baseline.constant_sigma * size[P : P + k]) ** -2.0
    return prior


def by_sensor(error: Array, baseline: Baseline) -> dict[str, dict[str, float]]:
    """Root mean square of errors (R, m), m/s² (rad/s), of every sensor by name, by kind."""
    rms = np.sqrt(np.mean(error**2, axis=0))
    found: dict[str, dict[str, float]] = {}
    for sensor, sensor_rms in zip(baseline.session.sensors, rms, strict=True):
        found.setdefault(sensor.kind, {})[sensor.name] = float(sensor_rms)
    return found


def root_mean_square(error: Array, baseline: Baseline) -> dict[str, float]:
    """Root mean square of errors (R, m), m/s² (rad/s), by kind of sensor: units are never mixed."""
    kinds = np.array(baseline.setting.kinds)
    by_kind = {str(kind): float(np.sqrt(np.mean(error[:, kinds == kind] ** 2))) for kind in dict.fromkeys(kinds)}
    return (
        by_kind
        if baseline.session.block in by_kind
        else {baseline.session.block: next(iter(by_kind.values())), **by_kind}
    )
