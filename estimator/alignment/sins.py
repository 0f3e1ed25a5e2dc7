"""Error model of a strapdown system that stands on a turntable: the states, their transition, what is measured.

Frames: n is east-north-up (E, N, U), b the block, C = C_b^n. The computed attitude is C̃ = (I − φ×)·C. With v = 0,
ω = (0, Ω cos L, Ω sin L) and the specific force (0, 0, g) in n:

    δv̇_E =  2Ω sin L·δv_N − g·φ_N + (C∇)_E          φ̇ = −ω × φ − C·(ε + δω)
    δv̇_N = −2Ω sin L·δv_E + g·φ_E + (C∇)_N          ε̇ = 0,  ∇̇ = 0

These are the ten states of Liu et al. (single-axis rotation alignment, equation (1)): δv_E, δv_N, φ_E, φ_N, φ_U,
ε_x, ε_y, ε_z, ∇_x, ∇_y. The computed velocity (δv_E, δv_N) is what is measured (2).

The gyros' mounting errors E_xz, E_yz and the scale error κ of the azimuth gyro act through the turn rate ω_z,

    δω = (E_xz·ω_z, E_yz·ω_z, κ·ω_z),

and are three further states. The turntable itself shows the attitude: its axis keeps its direction in n and its encoder
counts the turn θ, so that C·R_z(−θ) is one rotation T. The computed C̃·R_z(−θ) = (I − φ×)·T therefore shows φ but for
a constant τ and for the deviation ς of each stop, by which the axis wobbles and the encoder errs:

    y = φ + τ + ς,  when a stop begins and when it ends.

Accelerometers that stand away from the turn axis feel the turn (`levers`): C·(−ω²·c + α·d) of the block's x and y axes,
with c and d as the last four states. The turntable's model alone has them.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from estimator.applied_vector import EARTH_RATE
from estimator.session import Array

STATES = (
    "v_E", "v_N", "phi_E", "phi_N", "phi_U", "eps_x", "eps_y", "eps_z", "nabla_x", "nabla_y",
    "E_xz", "E_yz", "kappa_z", "tau_E", "tau_N", "tau_U", "stop_E", "stop_N", "stop_U",
    "along_x", "along_y", "across_x", "across_y",
)  # fmt: skip
"""Names of the states; every model has the first so many."""
UNITS = ("m/s",) * 2 + ("rad",) * 3 + ("rad/s",) * 3 + ("m/s²",) * 2 + ("rad", "rad", "1") + ("rad",) * 6 + ("m",) * 4
"""Units of `STATES`."""
V, PHI, EPS, NABLA, MOUNTING = slice(0, 2), slice(2, 5), slice(5, 8), slice(8, 10), slice(10, 13)
TAU, STOP, LEVER = slice(13, 16), slice(16, 19), slice(19, 23)
ALL = len(STATES)
"""Places of the states, and their number."""


class InertialModel(StrEnum):
    """The set of states that is estimated."""

    TEN = "ten-state"
    """The ten states as published: the mounting errors are taken to be zero."""
    MOUNTING = "mounting"
    """The ten states and E_xz, E_yz, κ, measured by velocity alone."""
    TURNTABLE = "turntable"
    """All of `STATES`: also the lever arms and the direction of the turntable, measured at every stop."""

    @property
    def size(self) -> int:
        """Number of states; those of every model are the first of `STATES`."""
        return {InertialModel.TEN: 10, InertialModel.MOUNTING: 13, InertialModel.TURNTABLE: ALL}[self]


@dataclass(frozen=True, eq=False)
class Path:
    """The attitude along an alignment, in steps of one length. K steps."""

    step: float
    """s."""
    mean: Array
    """(K, 3, 3) mean of C over each step, dimensionless."""
    turning: Array
    """(K, 3, 3) mean of C·ω_z over each step, rad/s."""
    levers: Array
    """(K, 3, 4) mean over each step of what (c_x, c_y, d_x, d_y) add to the specific force in n, 1/s²."""
    rate_known: NDArray[np.bool_]
    """(K,) whether the turn rate at the end of the step is known well enough to compare velocities there."""
    stop: Array
    """(K,) number of the stop that the table stands at for the whole step, −1 while it turns."""

    @property
    def begins(self) -> Array:
        """(K,) bool, no unit: whether a stop begins with this step."""
        return (self.stop >= 0) & (np.concatenate([[-1], self.stop[:-1]]) != self.stop)

    @property
    def ends(self) -> Array:
        """(K,) bool, no unit: whether a stop ends with this step."""
        return (self.stop >= 0) & (np.append(self.stop[1:], -1) != self.stop)


def earth_rate(latitude: float) -> Array:
    """(3,) rotation of the Earth in n, rad/s; latitude in rad."""
    return EARTH_RATE * np.array([0.0, np.cos(latitude), np.sin(latitude)])


def cross(v: Array) -> Array:
    """(3, 3) matrix of the cross product with v (3,), in its unit, rad/s or none; leading axes free."""
    zero = np.zeros_like(v[..., 0])
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def dynamics(path: Path, latitude: float, g: float) -> Array:
    """F (K, 23, 23) of ẋ = F·x, equation (1) with the states added, the mean over each step; SI."""
    F = np.zeros((len(path.mean), ALL, ALL))
    omega = earth_rate(latitude)
    F[:, 0, 1], F[:, 1, 0] = 2 * omega[2], -2 * omega[2]
    F[:, 0, 3], F[:, 1, 2] = -g, g
    F[:, V, NABLA] = path.mean[:, :2, :2]
    F[:, V, LEVER] = path.levers[:, :2]
    F[:, PHI, PHI] = -cross(omega)
    F[:, PHI, EPS] = -path.mean
    F[:, PHI, MOUNTING] = -path.turning
    return F


def transition(F: Array, step: float) -> Array:
    """Φ = exp(F·step) (K, n, n) of F (K, n, n), SI, and step in s; equal matrices are exponentiated once."""
    different, which = np.unique(F.reshape(len(F), -1), axis=0, return_inverse=True)
    return expm(different.reshape(-1, *F.shape[1:]) * step)[which.ravel()]


def process_noise(path: Path, Phi: Array, accelerometer: Array, gyro: Array) -> Array:
    """Q (K, 23, 23), SI, of white noise of densities (3, 3), (m/s²)²/Hz and (rad/s)²/Hz, by the trapezium in time.

    Phi : (K, 23, 23), SI.
    """
    density = np.zeros_like(Phi)
    C = path.mean
    density[:, V, V] = (C @ accelerometer @ C.swapaxes(1, 2))[:, :2, :2]
    density[:, PHI, PHI] = C @ gyro @ C.swapaxes(1, 2)
    return 0.5 * path.step * (density + Phi @ density @ Phi.swapaxes(1, 2))
