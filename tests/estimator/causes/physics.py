"""Every cause acted out: the stand really turned, the block really turned, the term of a sensor written out.

The stand is the chain of rotations of the accuracy tests; none of the causes' own code is used.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from estimator import CalibrationSession
from estimator.arrays import tangents
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, GYROSCOPE, Array
from tests.estimator.calibration.bound import Happened, applied

SENSOR = 1
"""Place of the sensor that sensor causes act on here."""


@dataclass(frozen=True, eq=False)
class World:
    """A schedule and the sensors that it is measured with."""

    session: CalibrationSession
    truth: SensorParameters

    def vectors(self, happened: Happened | None = None) -> Array:
        """(R, m, 3) applied vectors, block axes, m/s² or rad/s."""
        found = {k: applied(self.session, k, happened or Happened({})) for k in {s.kind for s in self.session.sensors}}
        return np.stack([found[s.kind] for s in self.session.sensors], axis=1)

    def inputs(self, n: Array, p: SensorParameters | None = None) -> Array:
        """(R, m) readings over the believed scale, m/s² or rad/s, of n (R, m, 3): (K'/K)·(a + b + c·a²)."""
        p = p or self.truth
        a = np.einsum("rmk,mk->rm", n, p.axis)
        return p.scale / self.truth.scale * (a + p.bias + p.quadratic * a**2)

    def of_kind(self, kind: str) -> Array:
        """(m,) dimensionless: 1 for sensors of a kind, 0 for others."""
        return np.array([s.kind == kind for s in self.session.sensors], dtype=float)


Acted = Callable[[World, Array, int, tuple[float, ...]], Array]
"""(world, amplitudes (p,) in the cause's units, sensor, nonlinear parameters) → (R, m) inputs with the effect, m/s² or
rad/s."""


def term(added: Callable[["Seen", tuple[float, ...]], tuple[Array, ...]]) -> Acted:
    """A term inside the bracket of one sensor: what is added per unit amplitude, p times (R,) m/s² or rad/s."""

    def acted(world: World, k: Array, i: int, nonlinear: tuple[float, ...]) -> Array:
        h = world.inputs(world.vectors())
        h[:, i] += np.stack(added(Seen(world, i), nonlinear), axis=-1) @ k
        return h

    return acted


class Seen:
    """Quantities at one sensor, in the letters of the table of causes."""

    def __init__(self, world: World, i: int):
        session, n = world.session, world.vectors()[:, i]
        self.a = n @ world.truth.axis[i]
        self.pn, self.on = (n @ tangents(world.truth.axis[i])).T
        self.t, self.beta = session.time, session.beta
        self.T = np.zeros_like(self.t) if session.temperature is None else session.temperature
        self.swing = np.zeros_like(self.t) if session.vibration is None else session.vibration[:, i]
        self.elapsed, self.warmth = self.t - np.mean(self.t), self.T - np.mean(self.T)
        self.force = applied(session, ACCELEROMETER, Happened({}))
        self.row, self.flipped = np.arange(len(n)), session.flipped

    def risen(self) -> Array:
        """(R,) sign(a_j − a_{j−1}), dimensionless, 0 at the first position of a run."""
        turned = np.diff(self.flipped.astype(int)) != 0
        return np.concatenate([[0.0], np.where(turned, 0.0, np.sign(np.diff(self.a)))])

    def rate(self) -> Array:
        """(R,) dT/dt from neighbouring rows, °C/s."""
        return np.gradient(self.T, self.t)

    def late(self, tau: float) -> Array:
        """(R,) K: T weighed by exp(−(t − s)/τ)/τ over the past s, steady before the first row; less its mean.

        By Gauss–Legendre quadrature of the temperature between neighbouring rows, in pieces short beside τ.
        """
        nodes, weights = np.polynomial.legendre.leggauss(6)
        ends = np.unique(np.concatenate([self.t, np.arange(self.t[0], self.t[-1], tau / 4)]))
        half, middle = np.diff(ends) / 2, (ends[1:] + ends[:-1]) / 2
        s, w = (middle[:, None] + half[:, None] * nodes).ravel(), (half[:, None] * weights).ravel()
        ago = (self.t[:, None] - s) / tau
        kernel = np.where(ago > 0, np.exp(-np.maximum(ago, 0)), 0.0)
        past = kernel @ (w * np.interp(s, self.t, self.T)) / tau
        found = past + self.T[0] * np.exp(-(self.t - self.t[0]) / tau)
        return found - found.mean()


def turned_head(alpha: Callable[[CalibrationSession], Array], beta: Callable[[CalibrationSession], Array]) -> Acted:
    """The head really stands elsewhere: α and β errors (R, p), rad per unit amplitude."""

    def acted(world: World, k: Array, i: int, nonlinear: tuple[float, ...]) -> Array:
        session = world.session
        happened = Happened({"alpha": (alpha(session) @ k)[:, None]}, beta(session) @ k)
        return world.inputs(world.vectors(happened))

    return acted


def still(session: CalibrationSession) -> Array:
    """(R, 1) no error, rad per unit amplitude."""
    return np.zeros((len(session.beta), 1))


def both(order: int) -> Callable[[CalibrationSession], Array]:
    """(R, 2) sin and cos of a multiple of β, dimensionless."""
    return lambda s: np.stack([np.sin(order * s.beta), np.cos(order * s.beta)], axis=-1)


def still_pair(session: CalibrationSession) -> Array:
    """(R, 2) no error, rad per unit of two amplitudes."""
    return np.zeros((len(session.beta), 2))


def constant(name: str, kind: str | None = None) -> Acted:
    """One constant error of the stand, for sensors of a kind only where one is named."""

    def acted(world: World, k: Array, i: int, nonlinear: tuple[float, ...]) -> Array:
        n, moved = world.vectors(), world.vectors(Happened({name: float(k[0])}))
        chosen = np.ones(n.shape[1]) if kind is None else world.of_kind(kind)
        return world.inputs(n + (moved - n) * chosen[:, None])

    return acted


def flipped_block(world: World, k: Array, i: int, nonlinear: tuple[float, ...]) -> Array:
    """(R, m) inputs, m/s² or rad/s: the block sits turned by k (3,), rad, in the flipped run, so n turns by −k."""
    n = world.vectors()
    flipped = world.session.flipped
    n[flipped] = Rotation.from_rotvec(-k).apply(n[flipped].reshape(-1, 3)).reshape(n[flipped].shape)
    return world.inputs(n)


def remounted(world: World, k: Array, i: int, nonlinear: tuple[float, ...]) -> Array:
    """(R, m) inputs, m/s² or rad/s, with all axes turned by k (3,), rad."""
    return world.inputs(world.vectors(), replace(world.truth, axis=Rotation.from_rotvec(k).apply(world.truth.axis)))


def heavier(world: World, k: Array, i: int, nonlinear: tuple[float, ...]) -> Array:
    """(R, m) inputs, m/s² or rad/s, with gravity larger by the share k (1,), dimensionless."""
    return world.inputs(world.vectors() * (1 + k[0] * world.of_kind(ACCELEROMETER))[:, None])


def moved_sensor(world: World, k: Array, i: int, nonlinear: tuple[float, ...]) -> Array:
    """(R, m) inputs, m/s² or rad/s, of one sensor moved by k (4,): relative scale, bias, two turns of the axis, rad.

    Only what ``nonlinear`` lets move moves.
    """
    k, p = k * np.array(nonlinear), world.truth
    scale, bias, axis = p.scale.copy(), p.bias.copy(), p.axis.copy()
    bias[i] = bias[i] + k[1]
    scale[i] *= 1 + k[0]
    turn = np.cross(p.axis[i], tangents(p.axis[i]) @ k[2:])
    axis[i] = Rotation.from_rotvec(turn).apply(p.axis[i])
    return world.inputs(world.vectors(), replace(p, scale=scale, bias=bias, axis=axis))


ACTED: dict[str, Acted] = {
    "cubic-nonlinearity": term(lambda s, x: (s.a**3,)),
    "scale-asymmetry": term(lambda s, x: (np.abs(s.a),)),
    "cross-coupling": term(lambda s, x: (s.a * s.pn, s.a * s.on)),
    "bias-temperature": term(lambda s, x: (s.warmth,)),
    "bias-temperature-curve": term(lambda s, x: (s.warmth, s.warmth**2)),
    "scale-temperature-curve": term(lambda s, x: (s.warmth * s.a, s.warmth**2 * s.a)),
    "scale-temperature": term(lambda s, x: (s.warmth * s.a,)),
    "bias-ramp": term(lambda s, x: (s.elapsed,)),
    "warm-up": term(lambda s, x: (np.exp(-s.t / x[0]),)),
    "bias-jump": term(lambda s, x: (np.where(s.row >= x[0], 1.0, 0.0),)),
    "hysteresis": term(lambda s, x: (s.risen(),)),
    "odd-quadratic": term(lambda s, x: (s.a * np.abs(s.a),)),
    "bias-asymmetry": term(lambda s, x: (np.sign(s.a),)),
    "cross-axis-quadratic": term(lambda s, x: (s.pn**2, s.pn * s.on)),
    "scale-ramp": term(lambda s, x: (s.elapsed * s.a,)),
    "axis-creep": term(lambda s, x: (s.pn * s.elapsed, s.on * s.elapsed)),
    "temperature-rate": term(lambda s, x: (s.rate(),)),
    "thermal-lag": term(lambda s, x: (s.late(x[0]),)),
    "vibration-rectification": term(lambda s, x: (s.swing - np.mean(s.swing),)),
    "bias-per-position": term(lambda s, x: (np.sin(s.beta), np.cos(s.beta))),
    "reading-outlier": term(lambda s, x: (np.where(s.row == x[0], 1.0, 0.0),)),
    "g-sensitivity": term(lambda s, x: tuple(s.force.T)),
    "beta-eccentricity": turned_head(still_pair, both(1)),
    "beta-second-harmonic": turned_head(still_pair, both(2)),
    "beta-scale": turned_head(still, lambda s: (s.beta - np.mean(s.beta))[:, None]),
    "axis-wobble": turned_head(both(1), still_pair),
    "alpha-shift": turned_head(lambda s: np.where(s.flipped, 1.0, 0.0)[:, None], still),
    "stand-drift": turned_head(lambda s: (s.time - np.mean(s.time))[:, None], still),
    "levelling-y": constant("theta_y"),
    "meridian-error": constant("meridian", GYROSCOPE),
    "latitude-entry": constant("latitude", GYROSCOPE),
    "alpha-entry": constant("alpha", ACCELEROMETER),
    "flip-misalignment": flipped_block,
    "remount-rotation": remounted,
    "gravity-entry": heavier,
    "sensor-drift": moved_sensor,
}
"""Every cause with a signature; clipping, which is no small change, is acted out where it is tested."""
