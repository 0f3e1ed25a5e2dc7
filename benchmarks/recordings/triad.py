"""Three accelerometers as one: readings → specific force, and the forms in which publications state them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import rq
from scipy.optimize import least_squares

from estimator.results import Calibration
from estimator.session import Array, Sensor


@dataclass(frozen=True, eq=False)
class Triad:
    """u = matrix·a + offset + matrix-row-length·quadratic·s², s = axis·a."""

    matrix: Array
    """(3, 3) rows K·e, reading unit per m/s²."""
    offset: Array
    """(3,) reading at zero input."""
    quadratic: Array
    """(3,) s²/m"""

    @property
    def scale(self) -> Array:
        """(3,) K"""
        return np.asarray(np.linalg.norm(self.matrix, axis=1))

    @property
    def axes(self) -> Array:
        """(3, 3) rows e."""
        return self.matrix / self.scale[:, None]

    def force(self, readings: Array) -> Array:
        """(R, 3) specific force of readings (R, 3); the quadratic term by fixed-point iteration."""
        linear = (readings - self.offset) / self.scale
        s = linear
        for _ in range(4):
            s = linear - self.quadratic * s * s
        return s @ np.linalg.inv(self.axes).T

    def misalignment(self) -> Array:
        """(3,) departures from a right angle of axes xy, xz, yz, rad: free of the choice of frame."""
        e = self.axes
        return np.arcsin([e[0] @ e[1], e[0] @ e[2], e[1] @ e[2]])

    def upper(self) -> Array:
        """(3, 3) the matrix in the frame in which it is upper triangular with a positive diagonal."""
        R = rq(self.matrix, mode="r")
        return np.asarray(R * np.sign(np.diagonal(R)))


def triad_of(result: Calibration, sensors: Sequence[Sensor]) -> Triad:
    """Three sensors of a calibration. A quadratic term that was not estimated is taken at zero."""
    found = [result.sensor(sensor.name) for sensor in sensors]
    K = np.array([s.scale.value for s in found], dtype=float)
    b = np.array([s.bias.value for s in found], dtype=float)
    c = np.array([s.quadratic.value or 0.0 for s in found])
    zero = np.array([sensor.nominal_offset or 0.0 for sensor in sensors])
    return Triad(K[:, None] * np.array([s.axis for s in found]), K * b + zero, c)


def nominal(scale: float, offset: float = 0.0) -> Triad:
    """An ideal triad: what one has without a calibration."""
    return Triad(scale * np.eye(3), np.full(3, offset), np.zeros(3))


def norm_fit(readings: Array, g: float, start: Triad) -> Triad:
    """The method of most publications: nine parameters, lower triangular, least squares of |a| − g."""
    lower = np.tril_indices(3)

    def made(x: Array) -> Triad:
        matrix = np.zeros((3, 3))
        matrix[lower] = x[:6]
        return Triad(start.scale[:, None] * matrix, start.offset + start.scale * g * x[6:], np.zeros(3))

    def miss(x: Array) -> Array:
        return np.asarray(np.linalg.norm(made(x).force(readings), axis=1) / g - 1)

    found = least_squares(miss, np.concatenate([np.eye(3)[lower], np.zeros(3)]), xtol=1e-12, ftol=1e-12)
    return made(found.x)
