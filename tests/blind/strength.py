"""Strength of a signature in a session: the part that baseline and common stand errors leave, whitened.

The covariance of all readings holds the noise of each reading, the β error that all sensors of a row share and the
stand's constant errors that all readings share. Derivatives are numerical, of our own physics.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from tests.blind.effects_sensor import across
from tests.blind.physics import StandErrors, mean_readings, true_input
from tests.blind.world import Array, Session, Unit

RANK = 1e-6
ELEMENTS = 5
ANGLE = 1e-5


def parameter_columns(session: Session) -> Array:
    """(R·m, 5·m) derivative of the readings by relative scale, bias, quadratic and two turns (rad) of each axis."""
    unit = session.unit
    R, m = session.schedule.rows, unit.size
    columns = np.zeros((R, m, m, ELEMENTS))
    size = np.abs(true_input(session)).max(axis=0)
    steps = [1e-3 + 0 * size, 1e-3 * size, 1e-3 / size, 1e-4 + 0 * size, 1e-4 + 0 * size]
    for element, step in enumerate(steps):
        up, down = (mean_readings(replace(session, unit=_stepped(unit, element, s * step))) for s in (1, -1))
        columns[:, np.arange(m), np.arange(m), element] = (up - down) / (2 * step)
    return columns.reshape(R * m, m * ELEMENTS)


def _stepped(unit: Unit, element: int, step: Array) -> Unit:
    """One element of every sensor moved."""
    if element == 0:
        return replace(unit, scale=unit.scale * (1 + step))
    if element == 1:
        return replace(unit, bias=unit.bias + step)
    if element == 2:
        return replace(unit, quadratic=unit.quadratic + step)
    sides = np.array([across(e)[element - 3] for e in unit.axis])
    return replace(unit, axis=unit.axis + step[:, None] * sides)


def covariance(session: Session) -> Array:
    """(R·m, R·m) covariance of the readings, reading units squared."""
    R, m = session.schedule.rows, session.unit.size
    own = session.unit.scale**2 * (session.noise.reading**2 + session.noise.repeatability**2)
    C = np.diag(np.tile(own, R))
    s = session.stand.sigma
    for sigma, which in ((s.theta_x, 0), (s.theta_y, 1), (s.alpha, 2)):
        column = sigma * _stand_column(session, which).ravel()
        C += np.outer(column, column)
    turned = s.beta * _stand_column(session, 3)
    rows = np.arange(R * m).reshape(R, m)
    for row, swing in zip(rows, turned, strict=True):
        C[np.ix_(row, row)] += np.outer(swing, swing)
    return C


def _stand_column(session: Session, which: int) -> Array:
    """(R, m) readings per rad of θ_x, θ_y, δα, or the row's own δβ."""

    def moved(by: float) -> Array:
        x, y, alpha, beta = (by * (which == k) for k in range(4))
        errors = StandErrors(x, y, alpha, np.full(session.schedule.rows, beta))
        return mean_readings(session, errors=errors)

    return (moved(ANGLE) - moved(-ANGLE)) / (2 * ANGLE)


class Lens:
    """View of a session: columns of readings → the part left of them, in standard errors of a reading."""

    def __init__(self, session: Session, prior: Array | None = None):
        """``prior`` (p, 5m): root of the information that other sessions or the maker give on the parameters."""
        self.session = session
        self._root = cholesky(covariance(session), lower=True)
        self.whitened = solve_triangular(self._root, parameter_columns(session), lower=True)
        self._added = 0 if prior is None else len(prior)
        baseline = self.whitened if prior is None else np.vstack([self.whitened, prior])
        self._basis = orthonormal(baseline)

    def information(self) -> Array:
        """(5m, 5m) on the parameters, one over their units squared."""
        return self.whitened.T @ self.whitened

    def whiten(self, columns: Array) -> Array:
        """(R·m + p, k) columns (R·m, k) of reading units in standard errors; the rows of the prior are zero."""
        white = solve_triangular(self._root, columns, lower=True)
        return np.vstack([white, np.zeros((self._added, columns.shape[1]))])

    def left(self, columns: Array) -> Array:
        """(R·m + p, k) remainder of columns (R·m, k) of readings after the baseline, standard errors."""
        white = self.whiten(columns)
        return white - self._basis @ (self._basis.T @ white)

    def without(self, columns: Array) -> "Lens":
        """The lens with further columns (R·m, k), reading units, taken into the baseline."""
        other = object.__new__(Lens)
        other.__dict__.update(self.__dict__)
        other._basis = np.hstack([self._basis, orthonormal(self.left(columns))])
        return other

    def strength(self, readings: Array) -> float:
        """Norm, in standard errors, of what is left of a difference of readings (R, m), reading units."""
        return float(np.linalg.norm(self.left(readings.reshape(-1, 1))))

    def noise_strength(self, sensor: int, sigma: float) -> float:
        """Strength of added variance: the root of twice its information, as for a mean of that norm."""
        left = self._noise_columns(sensor, sigma)
        grown = left.T @ left
        return float(np.sqrt(max(0.0, np.trace(grown) - np.linalg.slogdet(np.eye(len(grown)) + grown)[1])))

    def noise_evidence(self, sensor: int, sigma: float, left: Array) -> float:
        """Twice the log-likelihood ratio that added variance gains on what is ``left`` (n,), standard errors."""
        columns = self._noise_columns(sensor, sigma)
        grown = np.eye(columns.shape[1]) + columns.T @ columns
        seen = columns.T @ left
        return float(seen @ np.linalg.solve(grown, seen) - np.linalg.slogdet(grown)[1])

    def _noise_columns(self, sensor: int, sigma: float) -> Array:
        """(n, R) remainder of one sigma of added noise in each reading of a sensor."""
        R, m = self.session.schedule.rows, self.session.unit.size
        chosen = np.zeros((R * m, R))
        chosen[np.arange(R) * m + sensor, np.arange(R)] = sigma * self.session.unit.scale[sensor]
        return self.left(chosen)


def orthonormal(columns: Array) -> Array:
    """Orthonormal basis (n, r), dimensionless, of the span of (n, k); what is numerically nothing is left out."""
    size = np.linalg.norm(columns, axis=0)
    left, values, _ = np.linalg.svd(columns[:, size > 0] / size[size > 0], full_matrices=False)
    return left[:, values > RANK * values[:1]]


def root(information: Array) -> Array:
    """(p, p) matrix whose square is the information (p, p), which is one over the parameters' units squared."""
    values, vectors = np.linalg.eigh(information)
    return np.sqrt(np.clip(values, 0, None))[:, None] * vectors.T


def history_information(earlier: list[Session]) -> Array:
    """(5m, 5m) information of earlier sessions on the parameters, one over their units squared; one stand draw each."""
    total = np.zeros((0, 0))
    for session in earlier:
        information = Lens(session).information()
        total = information if total.size == 0 else total + information
    return total


NOMINAL_SCALE = 0.01 / np.sqrt(3)
NOMINAL_AXIS = np.radians(0.5) / np.sqrt(6)


def nominal_information(session: Session) -> Array:
    """(5m, 5m) information of the maker's nominal axes and scales, one over units squared, as loosely as units are
    drawn.
    """
    one = np.array([NOMINAL_SCALE**-2, 0, 0, NOMINAL_AXIS**-2, NOMINAL_AXIS**-2])
    return np.diag(np.tile(one, session.unit.size))
