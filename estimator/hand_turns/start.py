"""A start of the search that needs no scale, sign or axis: linear, from the directions that the accelerometers show.

What a turn changes is −∫ω × d, and d is, roughly, where the specific force points. The rate is linear in the readings,
of which three combinations turn with the block, ω = M·c. So M follows from the directions of the rests by linear least
squares, and S from M. The hand's own accelerations spoil it by a few per cent.
"""

import numpy as np

from estimator.arrays import unit
from estimator.hand_turns.integrate import attitude
from estimator.hand_turns.model import BIAS, TERMS, weights
from estimator.hand_turns.recording import RestDirections, TurnedLog
from estimator.session import Array

PLAIN = 0.02
"""Singular values below this part of the largest carry the hand's accelerations rather than turns."""


def start(log: TurnedLog, rests: RestDirections) -> Array:
    """(m, 7) p to begin with: by the nominal axes, or linear, whichever carries the directions better."""
    bias = log.rest.mean(axis=0)
    sets = [nominal for nominal in (log.axes, linear(log, rests, bias)) if nominal is not None]
    return min((with_bias(S, bias) for S in sets), key=lambda p: far_off(log, rests, p))


def with_bias(S: Array, bias: Array) -> Array:
    """(m, 7) p of S (m, 3), dimensionless, and bias (m,), rad/s; no answer to force."""
    return np.column_stack([S, bias, np.zeros((len(S), TERMS - BIAS - 1))])


def far_off(log: TurnedLog, rests: RestDirections, p: Array) -> float:
    """Median distance, rad, by which the turns miss the next rest."""
    rate = (log.readings - p[:, BIAS]) @ weights(p[:, :BIAS], log.noise).W.T
    C = attitude(np.where(log.turning[:, None], rate, 0.0), log.step)
    carried = C[log.start] @ rests.up[..., None]
    return float(np.median(np.linalg.norm(np.diff(carried[..., 0], axis=0), axis=1)[log.whole]))


def linear(log: TurnedLog, rests: RestDirections, bias: Array) -> Array | None:
    """(m, 3) S, dimensionless, by linear least squares; None where the turns do not determine it."""
    r = np.where(log.turning[:, None], log.readings - bias, 0.0)
    basis = np.linalg.svd(r.T @ r)[0][:, :3]
    up = unit(np.where(log.turning[:, None], log.force, rests.up[0]))
    c = r @ basis
    products = log.sums((up[:, :, None] * c[:, None]).reshape(len(r), 9)).reshape(-1, 3, 3)[log.whole]
    design = log.step * np.einsum("abe,tec->tabc", -LEVI_CIVITA, products).reshape(-1, 9)
    change = np.diff(rests.up, axis=0)[log.whole].ravel()
    size = np.linalg.svd(design, compute_uv=False)
    if len(size) < 9 or size[-1] < PLAIN * size[0]:
        return None
    M = np.linalg.lstsq(design, change, rcond=None)[0].reshape(3, 3)
    return np.asarray(basis @ np.linalg.pinv(M))


LEVI_CIVITA = np.zeros((3, 3, 3))
"""ε, dimensionless: (a × b)_i = ε_ijk·a_j·b_k."""
LEVI_CIVITA[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0
LEVI_CIVITA[[0, 1, 2], [2, 0, 1], [1, 2, 0]] = -1.0
