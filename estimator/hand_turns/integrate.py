"""Rotation from samples of the rate, and what errors of the rate do to the direction at the end of a turn.

Theory
------
Over one step Δ the rotation vector of a smooth rate is, to the fourth order (Magnus; Iserles & Nørsett 1999, Phil.
Trans. R. Soc. A 357, 983, with the mean rate by cubic interpolation of four samples),

    θ_k = Δ·(13·(ω_k + ω_k+1) − ω_k−1 − ω_k+2)/24 + Δ²/12·ω_k × ω_k+1

The second term is the coning. C_k+1 = C_k·exp[θ_k×] takes components in the block at k + 1 to those at the start. The N
products are made in √N rounds, each of one step in √N stretches of the log at once.

An error δ_k of the rate turns the end by a = Δ·Σ C_k·δ_k, seen at the start, which moves a direction d fixed in space,
as the block sees it at the end, by d × (Cᵀ·a).
"""

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.session import Array


def rotation_vectors(rate: Array, step: float) -> Array:
    """(N − 1, 3) θ, rad, from one sample of the rate (N, 3), rad/s, to the next, ``step`` seconds later."""
    padded = np.concatenate([rate[:1], rate, rate[-1:]])
    mean = (13 * (rate[:-1] + rate[1:]) - padded[:-3] - padded[3:]) / 24
    return np.asarray(step * mean + step**2 / 12 * np.cross(rate[:-1], rate[1:]))


def product(left: Array, right: Array) -> Array:
    """Product of quaternions (…, 4), the scalar last: turned by ``right`` first."""
    x, y, z, w = np.moveaxis(left, -1, 0)
    a, b, c, d = np.moveaxis(right, -1, 0)
    parts = w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a, w * c + x * b - y * a + z * d
    return np.stack([*parts, w * d - x * a - y * b - z * c], axis=-1)


def chained(vectors: Array) -> Array:
    """(N + 1, 4) quaternions C: the first none, each next one turned on by a rotation vector of (N, 3), rad."""
    N = len(vectors) + 1
    length = round(N**0.5) + 1
    steps = np.zeros((-(-N // length) * length, 3))
    steps[1:N] = vectors
    q = np.asarray(Rotation.from_rotvec(steps).as_quat()).reshape(-1, length, 4)
    for j in range(1, length):
        q[:, j] = product(q[:, j - 1], q[:, j])
    begin = np.tile([0.0, 0.0, 0.0, 1.0], (len(q), 1))
    for k in range(1, len(q)):
        begin[k] = product(begin[k - 1], q[k - 1, -1])
    return product(begin[:, None], q).reshape(-1, 4)[:N]


def attitude(rate: Array, step: float) -> Array:
    """(N, 3, 3) C of every sample of the rate (N, 3), rad/s, to the block's axes at the first."""
    return np.asarray(Rotation.from_quat(chained(rotation_vectors(rate, step))).as_matrix())
