"""Noise of the readings where the file does not state it, and the check of the one it states.

Theory
------
Restricted likelihood: with P the inverse noise covariance after the model is fitted, the variance v of a sensor's
readings satisfies v²·y'PAPy = v·tr(PA), A the identity on its readings (Patterson & Thompson 1971, Biometrika 58,
545). Both sides are of the readings in units of v: the energy E of their residuals and its degrees of freedom f. What
the stand's errors do to all sensors at once is weighed off by their covariance; where they are larger than the noise, a
moment estimate is the small difference of two large numbers.

Sensors of one kind in one block are alike: their variances are taken as drawn about a common value v₀ with `ALIKE`
degrees of freedom, v = (E + d₀v₀)/(f + d₀) (Smyth 2004, Stat. Appl. Genet. Mol. Biol. 3, 3). A sensor of few rows
borrows from the others, unless it is plainly noisier than they are.
"""

from dataclasses import dataclass

import numpy as np
from scipy import special

from estimator.applied_vector import Geometry
from estimator.calibration.refine import FINEST, designed, linearise
from estimator.parameters import SensorParameters
from estimator.session import Array

SUSPICIOUS = 1e-3
"""Below this p-value the stated noise cannot explain the residuals, and the covariance is enlarged: true noise is
mistrusted once in a thousand sessions."""

ALIKE = 6.0
"""Degrees of freedom with which a sensor's noise is known from the others of its kind: sigmas differ by a third."""

CONTRADICTED = 0.01
"""p-value of a sensor's own scatter below which it is noisier than the others of its kind: in a block of six
alike, one is taken for noisier in 6 % of the sessions, and then merely keeps its own estimate."""

LEAST = 1.0
"""Degrees of freedom that a noise of its own is divided by at least: fewer tell no variance."""

NO_FREEDOM = 0.5
"""Degrees of freedom at or below which the readings tell nothing of their noise: of rows of stated noise they are whole
numbers, and rounding leaves less than this of none."""

STEADY = 0.01
"""Relative change of every variance at which the estimate stands: far below the scatter of any estimated variance."""

MOST_STEPS = 30
"""Well-posed sessions settle in fewer than ten; this ends the others."""

TOGETHER = 256
"""Sessions worked on at a time: bounds the memory of the columns, (S, R, m, P)."""


def with_estimated(variance: Array, y: Array, p: SensorParameters, geometry: Geometry) -> Array:
    """Variances of the readings, those not stated estimated from what the model leaves of all sensors; each session's
    until they stand themselves, so that it does not matter which sessions are worked on together.

    Parameters
    ----------
    variance : (S, R, m) at the input, (m/s²)² or (rad/s)²; NaN where it is not stated, infinite for readings that take
        no part.
    y : (S, R, m) readings, offset taken off, reading units.
    p : (S, m), close to the solution.

    Returns
    -------
    (S, R, m) at the input, an estimated one constant over the rows.
    """
    parts = np.split(np.arange(len(y)), range(TOGETHER, len(y), TOGETHER))
    return np.concatenate([_estimated(variance[k], y[k], p.at(k), geometry) for k in parts])


def _estimated(variance: Array, y: Array, p: SensorParameters, geometry: Geometry) -> Array:
    unstated, floor = np.isnan(variance), (FINEST * geometry.norm) ** 2
    sensors = np.asarray(unstated.any(axis=1))
    residual = linearise(y, p, geometry, np.ones(y.shape))[1]
    value, k = np.maximum((residual**2).mean(axis=1), floor), np.arange(len(y))
    for _ in range(MOST_STEPS):
        known = np.where(unstated[k], value[k, None, :], variance[k])
        energy, freedom = residual_energy(known, y[k], p.at(k), geometry, unstated[k])
        energy, freedom = with_the_others(energy, freedom, typical(value[k], sensors[k], geometry.norm))
        new = np.maximum(energy / np.maximum(freedom, LEAST), floor)
        change = np.where(sensors[k], new / value[k], 1.0)
        value[k] *= change
        k = k[~(np.abs(np.log(change)).max(axis=1) < STEADY)]
        if not len(k):
            break
    return np.where(unstated, value[:, None, :], variance)


@dataclass(frozen=True, eq=False)
class Projection:
    """Residuals of the readings, and the dependence of the parameters on them. P parameters, k constant errors."""

    pulled: Array
    """(S, R, m) residuals weighted by P, 1/(m/s²) or 1/(rad/s)."""
    diagonal: Array
    """(S, R, m) diagonal of P, 1/(m/s²)² or 1/(rad/s)²."""
    lean: Array
    """(S, R, m, P + k) change of each estimate with each reading, dimensionless elements and rad (s) per m/s²
    (rad/s)."""
    inverse: Array
    """(S, P + k, P + k) covariance of the estimates, products of their units."""


def projection_of(variance: Array, y: Array, p: SensorParameters, geometry: Geometry) -> Projection:
    """The projection of readings y (S, R, m), reading units, of ``variance`` (S, R, m) at the input, (m/s²)² or
    (rad/s)².
    """
    S, R, m = y.shape
    weight = 1.0 / variance
    normal, residual = linearise(y, p, geometry, weight)
    inverse = np.linalg.inv(normal.matrix)
    design, beta = designed(p, geometry)
    columns = np.zeros((S, R, m, len(inverse[0])))
    index = np.arange(m)
    columns[..., : 5 * m].reshape(S, R, m, m, 5)[:, :, index, index] = design[..., :5]
    columns[..., 5 * m :] = design[..., 5:]
    swing = weight * beta * geometry.beta_sigma
    shared = 1.0 + (swing * beta * geometry.beta_sigma).sum(axis=-1, keepdims=True)

    def weighted(values: Array) -> Array:
        """P of the rows, per the noise's variance, times values (S, R, m, k) of any unit."""
        common = (swing[..., None] * values).sum(axis=2, keepdims=True) / shared[..., None]
        return weight[..., None] * values - swing[..., None] * common

    residuals = residual[..., None] - columns @ (inverse @ normal.rhs[..., None])[:, None]
    leaning = weighted(columns)
    lean = leaning @ inverse[:, None]
    diagonal = weight - swing**2 / shared - (lean * leaning).sum(axis=-1)
    return Projection(weighted(residuals)[..., 0], diagonal, lean, inverse)


def residual_energy(
    variance: Array, y: Array, p: SensorParameters, geometry: Geometry, included: Array
) -> tuple[Array, Array]:
    """Energy E of the residuals of each sensor's counted readings, and its degrees of freedom f: (S, m) each.

    ``variance`` (S, R, m) at the input, (m/s²)² or (rad/s)², and so is E; ``y`` (S, R, m) reading units; ``included``
    (S, R, m) bool.
    """
    projection, selected = projection_of(variance, y, p, geometry), np.where(included, variance, 0.0)
    return ((selected * projection.pulled) ** 2).sum(axis=1), (selected * projection.diagonal).sum(axis=1)


def freedom_of(variance: Array, y: Array, p: SensorParameters, geometry: Geometry, unstated: Array) -> Array:
    """(S, P) effective degrees of freedom of the parameters' variances, the stand's stated errors among their parts.

    Satterthwaite, as for arbitrary orientations (`estimator.calibration.free.noise`), T taken as the diagonal of the f:
    on a stand the sensors' residuals have little in common. Infinite where no estimated noise has a part; NaN of a
    sensor whose noise cannot be estimated, its own rows or others of its kind.

    variance, y : (S, R, m) as in `with_estimated`, but all variances known; unstated : (S, R, m) bool.
    """
    parts = np.split(np.arange(len(y)), range(TOGETHER, len(y), TOGETHER))
    return np.concatenate([_freedom(variance[k], y[k], p.at(k), geometry, unstated[k]) for k in parts])


def _freedom(variance: Array, y: Array, p: SensorParameters, geometry: Geometry, unstated: Array) -> Array:
    projection, selected = projection_of(variance, y, p, geometry), np.where(unstated, variance, 0.0)
    energy, freedom = ((selected * projection.pulled) ** 2).sum(axis=1), (selected * projection.diagonal).sum(axis=1)
    sensors, P = np.asarray(unstated.any(axis=1)), 5 * y.shape[2]
    value = np.where(sensors, selected.max(axis=1), np.nan)
    borrows = with_the_others(energy, freedom, typical(value, sensors, geometry.norm))[1] > freedom
    information = freedom[..., None] * np.eye(len(sensors[0]))
    known = np.zeros_like(sensors)
    for norm in np.unique(geometry.norm):
        b = np.where(sensors & borrows & (geometry.norm == norm), 1.0, 0.0)
        together = b[:, :, None] * b[:, None, :] / np.maximum(b.sum(axis=1), 1.0)[:, None, None]
        information = information + ALIKE * (b[..., None] * np.eye(len(b[0])) - together)
        known |= (b > 0) & ((b * freedom).sum(axis=1, keepdims=True) > NO_FREEDOM)
    known |= sensors & (freedom > NO_FREEDOM)
    gradient = np.einsum("srm,srmp->spm", selected, projection.lean[..., :P] ** 2)
    inverse = np.linalg.pinv(information, hermitian=True)
    doubt = ((gradient @ inverse) * gradient).sum(axis=-1)
    total = np.diagonal(projection.inverse, axis1=1, axis2=2)[:, :P]
    freedoms = np.where(doubt > 0, total**2 / np.where(doubt > 0, doubt, 1.0), np.inf)
    return np.where(np.repeat(sensors & ~known, 5, axis=1), np.nan, freedoms)


def typical(value: Array, sensors: Array, norm: Array) -> Array:
    """(S, m) the variance to expect of each sensor: the median, in logarithms, of those of its kind.

    value (S, m), (m/s²)² or (rad/s)², of the ``sensors`` (S, m) bool that state none; NaN for the others. ``norm`` (m,)
    is the length of the applied vector, m/s² (rad/s), by which the kinds are distinguished.
    """
    logarithms = np.where(sensors, np.log(value), np.nan)
    variances = np.full(value.shape, np.nan)
    for kind in np.unique(norm):
        alike = norm == kind
        known = sensors[:, alike].any(axis=1)
        variances[np.ix_(known, alike)] = np.exp(median(logarithms[np.ix_(known, alike)]))[:, None]
    return np.where(sensors, variances, np.nan)


def median(values: Array) -> Array:
    """(S,) medians of the rows of values (S, k), in their unit, without NaN; every row holds a number.
    `numpy.nanmedian` takes a millisecond for it.
    """
    rising, known = np.sort(values, axis=1), (~np.isnan(values)).sum(axis=1, keepdims=True)
    lower, upper = (np.take_along_axis(rising, place, axis=1)[:, 0] for place in ((known - 1) // 2, known // 2))
    return np.asarray((lower + upper) / 2)


def with_the_others(energy: Array, freedom: Array, expected: Array) -> tuple[Array, Array]:
    """Energy and degrees of freedom, each (S, m) or any shape, of sensors' own scatter with what the others add.

    energy, expected : variances of one unit, (m/s²)², (rad/s)² or relative. Nothing is borrowed where the own scatter
    contradicts it, nor where ``expected`` is NaN.
    """
    usual = special.fdtri(np.maximum(freedom, 1.0), ALIKE, 1 - CONTRADICTED)
    borrows = energy < usual * expected * np.maximum(freedom, 1.0)
    return energy + np.where(borrows, ALIKE * expected, 0.0), freedom + np.where(borrows, ALIKE, 0.0)
