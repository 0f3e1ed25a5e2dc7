"""The functional of the multi-parameter optimisation paper: the specific force from every three sensors, against g.

Theory
------
Readings u_ij (orientation j, sensor i), nominal scale taken out. With the parameters of the paper,

    a_ij = k_i·u_ij − b_i             k the reciprocal of the scale factor K                             (1)
    n_jt = E_t⁻¹ a_jt                 E_t (3, 3): the axes of triple t                                   (2), (3)
    F    = Σ_j Σ_t (|n_jt| − g)²      (m/s²)², over all orientations and triples                         (5)

Each axis may turn by two angles about its nominal direction. Three of the 2 m angles are fixed, because the norm of a
vector says nothing of the frame: both of the first axis, and the turn of the second axis about the first. That leaves
4 m − 3 parameters: 13 for four accelerometers. The paper fixes one α and two β; so does this.
Triples whose axes lie nearly in one plane are left out (a block of four of the paper has none).

Source: multi-parameter optimisation paper, equations (1) to (5); printed without its formulas, which are rebuilt from
the text. No quadratic term, as there.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import gravity
from estimator.arrays import unit
from estimator.errors import Problem, ScheduleError
from estimator.forward import measured
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array, CalibrationSession
from estimator.wording import few

FLATTEST = 0.05
"""|det E| below which a triple is left out: its inverse would make twentyfold noise of every reading's."""


@dataclass(frozen=True, eq=False)
class Triples:
    """Data of the functional. R orientations, m sensors, T triples, P = 4 m − 3 parameters."""

    u: Array
    """(R, m) readings over nominal scale, m/s²."""
    g: float
    """m/s²"""
    nominal_scale: Array
    """(m,) reading units per m/s²."""
    nominal_axes: Array
    """(m, 3) unit vectors."""
    frames: Array
    """(m, 3, 2) unit vectors along which α and β turn each axis."""
    members: NDArray[np.intp]
    """(T, 3) sensors of each triple."""
    free: NDArray[np.intp]
    """(P,) places of the parameters among the 4 m of (δk, b/g, α, β), sensor after sensor."""

    def spread(self, x: Array) -> Array:
        """(m, 4) all elements, the fixed ones zero, from x (P,); dimensionless (relative, g, rad)."""
        full = np.zeros(4 * len(self.nominal_scale))
        full[self.free] = x
        return full.reshape(-1, 4)

    def axes(self, full: Array) -> Array:
        """(m, 3) unit vectors, from all elements (m, 4), dimensionless."""
        return unit(self.nominal_axes + (self.frames @ full[:, 2:, None])[..., 0])

    def forces(self, x: Array) -> tuple[Array, Array]:
        """n of every orientation and triple (R, T, 3), m/s², and the inverse axes (T, 3, 3), at x (P,); (1)–(3)."""
        full = self.spread(x)
        a = (1.0 + full[:, 0]) * self.u - self.g * full[:, 1]
        inverse = np.linalg.inv(self.axes(full)[self.members])
        return np.einsum("tij,rtj->rti", inverse, a[:, self.members]), inverse

    def misses(self, x: Array) -> Array:
        """(R T,) |n| − g, m/s², at x (P,)."""
        return (np.sqrt((self.forces(x)[0] ** 2).sum(axis=-1)) - self.g).ravel()

    def functional(self, x: Array) -> float:
        """F, (m/s²)², at x (P,); (5)."""
        f = self.misses(x)
        return float(f @ f)

    def jacobian(self, x: Array) -> Array:
        """(R T, P) derivative of `misses`, m/s² per element, at x (P,)."""
        n, inverse = self.forces(x)
        R, T, m = len(self.u), len(self.members), len(self.nominal_scale)
        weight = np.einsum("rti,tij->rtj", n / np.linalg.norm(n, axis=-1, keepdims=True), inverse)
        turned = self.axis_derivative(self.spread(x))[self.members]
        columns = np.empty((R, T, 3, 4))
        columns[..., 0] = weight * self.u[:, self.members]
        columns[..., 1] = -self.g * weight
        columns[..., 2:] = -weight[..., None] * np.einsum("tsia,rti->rtsa", turned, n)
        full = np.zeros((R, T, m, 4))
        np.put_along_axis(full, np.broadcast_to(self.members[None, :, :, None], (R, T, 3, 1)), columns, axis=2)
        return full.reshape(R * T, 4 * m)[:, self.free]

    def axis_derivative(self, full: Array) -> Array:
        """(m, 3, 2) derivative of each unit axis by its α and β, 1/rad, at all elements (m, 4)."""
        raw = self.nominal_axes + (self.frames @ full[:, 2:, None])[..., 0]
        length = np.linalg.norm(raw, axis=1)[:, None, None]
        e = raw[:, :, None] / length
        return (self.frames - e * (e * self.frames).sum(axis=1, keepdims=True)) / length

    def parameters(self, x: Array) -> SensorParameters:
        """K, b and e (m,) in the terms of the package page, SI, from x (P,); c zero."""
        full = self.spread(x)
        return SensorParameters(
            scale=self.nominal_scale / (1.0 + full[:, 0]),
            bias=self.g * full[:, 1],
            quadratic=np.zeros(len(full)),
            axis=self.axes(full),
        )


def triples_of(session: CalibrationSession) -> Triples:
    """The functional of an averaged session in arbitrary orientations.

    Raises
    ------
    ScheduleError : fewer readings than parameters, or sensors other than accelerometers.
    """
    if any(s.kind != ACCELEROMETER for s in session.sensors):
        raise ScheduleError([Problem("sensors", "the triples functional takes accelerometers only")])
    axes = np.stack([s.nominal_axis for s in session.sensors])
    scale = np.array([s.nominal_scale for s in session.sensors])
    m, R = len(axes), len(session.readings)
    members = np.array([t for t in combinations(range(m), 3) if abs(np.linalg.det(axes[list(t)])) > FLATTEST])
    if not len(members):
        raise ScheduleError([Problem("sensors", "every three of the nominal axes lie nearly in one plane")])
    frames, second = gauge(axes)
    fixed = {2, 3, 4 * second + 3}
    free = np.array([k for k in range(4 * m) if k not in fixed])
    if (m - 2) * R < len(free):
        problem = f"{few(R, 'orientation')}: fewer equations than {len(free)} parameters"
        raise ScheduleError([Problem("table", problem)])
    return Triples(measured(session)[0] / scale, gravity(session.site), scale, axes, frames, members, free)


def gauge(axes: Array) -> tuple[Array, int]:
    """Turning directions (m, 3, 2), unit vectors, of axes (m, 3), and the sensor whose β is fixed beside the first's.

    β turns an axis about the first one, α towards or away from it; the first axis, which does not turn, takes any.
    """
    along = axes @ axes[0]
    second = 1 + int(np.argmin(np.abs(along[1:])))
    around = np.cross(axes[0], axes)
    around[np.linalg.norm(around, axis=1) < FLATTEST] = np.cross(axes[0], axes[second])
    around = unit(around - axes * (around * axes).sum(axis=1, keepdims=True))
    return np.stack([np.cross(around, axes), around], axis=-1), second
