"""Rotations as rotations: vector and matrix, how one changes with the other, and a start that outliers do not drag.

R(θ) = exp[θ×] turns by |θ| about θ (Rodrigues). A small turn δ after it, R(δ)·R(θ) = R(θ + J⁻¹(θ)·δ), moves the
rotation vector by the inverse of the left Jacobian J (Barfoot, State Estimation for Robotics, 2017, (7.77)).
"""

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.arrays import nearest_turn
from estimator.session import Array

SMALL = 1e-4
"""rad below which the series' next term, θ⁴/120, is below rounding."""
FAINT = 1e-9
"""Weight of no turn at all: above the rounding of vectors that share a line, and nothing beside any that do not."""
ROUNDS = 30
"""Rounds of reweighting; a start needs no more."""
CLOSEST = 1e-9
"""Distance, rad (0.0002″), below which vectors weigh alike: a perfect agreement may not weigh without bound."""
SETTLED = 1e-12
"""Change of a direction cosine below which a round has moved nothing: a thousandth of `CLOSEST`."""


def turn_of(vector: Array) -> Array:
    """(3, 3) R(θ), dimensionless, of a rotation vector (3,), rad; a leading axis is free."""
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def vector_of(turn: Array) -> Array:
    """(3,) θ, rad, |θ| ≤ π, of a rotation (3, 3), dimensionless."""
    return np.asarray(Rotation.from_matrix(turn).as_rotvec())


def cross_matrix(vector: Array) -> Array:
    """(3, 3) [θ×] of a vector (3,), in its unit."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def left_jacobian(vector: Array) -> Array:
    """(3, 3) J, dimensionless: R(θ + dθ) = R(J·dθ)·R(θ) for a rotation vector θ (3,), rad."""
    angle = float(np.linalg.norm(vector))
    if angle < SMALL:
        first, second = 0.5 - angle**2 / 24, 1 / 6 - angle**2 / 120
    else:
        first, second = (1 - np.cos(angle)) / angle**2, (angle - np.sin(angle)) / angle**3
    across = cross_matrix(vector)
    return np.eye(3) + first * across + second * across @ across


def common_turn(vectors: Array, others: Array, settled: float = SETTLED) -> Array:
    """(3, 3) rotation R, dimensionless, with the least sum of |R·v − w| of n vectors v and others w, (n, 3) each;
    leading axes are free.

    Distances, not their squares: the few vectors that moved otherwise hardly drag it (Weiszfeld's reweighting of
    Kabsch). About a line that all vectors share there is no turn. A place to linearise about, not an estimate.
    ``settled``: change of a direction cosine below which a round has moved nothing.
    """
    base = np.broadcast_to(np.eye(3), (*vectors.shape[:-2], 3, 3))
    targets, faint = np.concatenate([others, base], axis=-2), FAINT * base
    turn = nearest_turn(np.concatenate([vectors, faint], axis=-2), targets)
    moving = np.ones(turn.shape[:-2], dtype=bool)
    for _ in range(ROUNDS):
        difference = vectors @ np.swapaxes(turn, -1, -2) - others
        near = np.maximum(np.linalg.norm(difference, axis=-1, keepdims=True), CLOSEST)
        weighted = vectors * (near.min(axis=-2, keepdims=True) / near)
        new = nearest_turn(np.concatenate([weighted, faint], axis=-2), targets)
        moved = np.abs(new - turn).max(axis=(-1, -2)) >= settled
        turn, moving = np.where(moving[..., None, None], new, turn), moving & moved
        if not moving.any():
            break
    return turn
