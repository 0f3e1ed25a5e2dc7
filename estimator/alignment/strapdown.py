"""Strapdown: rates and specific forces in the block → attitude and velocity in n, in steps for the filter.

The attitude is C(t) = N(t)ᵀ·C(0)·R₁…R_j: R_j turns the block through row j, N turns n with the Earth. The velocity
obeys v̇ = C·f + g − 2ω×v with its own v; the block stands, so v is the velocity error. Source: see `sins`.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.alignment.levers import turning
from estimator.alignment.sins import Path, earth_rate
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class BlockMotion:
    """Motion of a block, true or as measured: means over rows of one length. R rows, block axes."""

    rates: Array
    """(R, 3) rad/s."""
    forces: Array
    """(R, 3) specific force, m/s²."""
    row: float
    """Time of a row, s."""


@dataclass(frozen=True, eq=False)
class Strapdown:
    """Attitude and velocity computed by a strapdown system. K steps."""

    path: Path
    attitude: Array
    """(K, 3, 3) C̃ at the end of each step, dimensionless."""
    velocity: Array
    """(K, 2) east and north at the end of each step, m/s."""


def attitudes(start: Array, rates: Array, row: float, latitude: float, per_step: int) -> Array:
    """(K, B, 3, 3) C̃, dimensionless, at the end of every row, in K steps of B rows.

    Parameters
    ----------
    start : (3, 3) C̃ at the beginning.
    rates : (K·B, 3) mean over each row, rad/s.
    row : s.
    latitude : rad.
    """
    steps = len(rates) // per_step
    turns = Rotation.from_rotvec(rates * row).as_matrix().reshape(steps, per_step, 3, 3)
    for j in range(1, per_step):
        turns[:, j] = turns[:, j - 1] @ turns[:, j]
    ahead = np.empty((steps, 3, 3))
    ahead[0] = start
    for k in range(1, steps):
        ahead[k] = ahead[k - 1] @ turns[k - 1, -1]
    elapsed = row * np.arange(1, len(rates) + 1)
    earth = Rotation.from_rotvec(elapsed[:, None] * earth_rate(latitude)).as_matrix()
    turned = ahead[:, None] @ turns
    return np.asarray(earth.reshape(turned.shape).swapaxes(2, 3) @ turned)


def strapdown(start: Array, motion: BlockMotion, latitude: float, stop_of_row: Array, per_step: int) -> Strapdown:
    """Attitude and velocity from the first row on.

    Parameters
    ----------
    start : (3, 3) C̃ at the beginning, dimensionless.
    motion : as measured; rows beyond the last whole step are left out.
    latitude : rad.
    stop_of_row : (R,) number of the stop that a row belongs to, −1 while the table turns.
    per_step : rows of a step.
    """
    row, steps = motion.row, len(motion.rates) // per_step
    rows = steps * per_step
    rates, forces = motion.rates[:rows], motion.forces[:rows]
    ends = attitudes(start, rates, row, latitude, per_step)
    back = Rotation.from_rotvec(-0.5 * row * rates).as_matrix().reshape(ends.shape)
    middle = Rotation.from_rotvec(0.5 * row * earth_rate(latitude)).as_matrix() @ ends @ back
    increments = (middle @ forces.reshape(steps, per_step, 3, 1))[..., 0].sum(axis=1) * row
    rate_z = rates[:, 2].reshape(steps, per_step, 1, 1)
    turned = turning(motion.rates[:, 2], row)
    felt = turned.columns[:rows].reshape(steps, per_step, 1, 2)
    level = middle[..., :2]
    path = Path(
        step=row * per_step,
        mean=middle.mean(axis=1),
        turning=(middle * rate_z).mean(axis=1),
        levers=np.concatenate([(level * felt[..., :1]).mean(axis=1), (level * felt[..., 1:]).mean(axis=1)], axis=2),
        rate_known=turned.known[:rows].reshape(steps, per_step)[:, -1],
        stop=stop_of_steps(stop_of_row[:rows].reshape(steps, per_step)),
    )
    return Strapdown(path, ends[:, -1], velocities(increments, path.step, latitude))


def velocities(increments: Array, step: float, latitude: float) -> Array:
    """(K, 2) horizontal velocity, m/s, from its increments (K, 3), m/s, by specific force, with the Earth's rotation.

    step in s, latitude in rad.
    """
    turn = 2j * earth_rate(latitude)[2] * step
    time = np.arange(1, len(increments) + 1)
    gained = (increments[:, 0] + 1j * increments[:, 1]) * np.exp(turn * (time - 0.5))
    velocity = np.cumsum(gained) * np.exp(-turn * time)
    return np.column_stack([velocity.real, velocity.imag])


def stop_of_steps(stop_of_row: Array) -> Array:
    """(K,) number of the stop that a whole step belongs to, −1 while the table turns; from that of every row (K, B)."""
    return np.where((stop_of_row == stop_of_row[:, :1]).all(axis=1), stop_of_row[:, 0], -1)
