"""Scores of candidates from their score vector and information alone: no residuals are needed any more."""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import eigh
from estimator.groups.statistics import Block
from estimator.least_squares import given, scale_of
from estimator.session import Array
from estimator.significance import equivalent_chi2

FAINT = 0.02
"""Share of the strongest direction's trace above which a direction of a candidate counts as an amplitude of its own: a
weaker one would cost a degree of freedom for an amplitude that the sessions hardly show."""

LEFT = 1e-4
"""Share of a candidate's information that others must leave, for it to be asked beside them: below it is one of them.
"""


def starts_of(blocks: Sequence[Block]) -> Array:
    """(B + 1,) int, dimensionless: first column of every block, and their number."""
    return np.concatenate([[0], np.cumsum([b.width for b in blocks])]).astype(int)


def eigen_scores(blocks: Sequence[Block], U: Array, F: Array) -> tuple[Array, Array]:
    """(B,) χ² and (B,) degrees of freedom of every block; ``U`` (D,) and ``F`` (D, D) in any units."""
    starts, widths = starts_of(blocks), np.array([b.width for b in blocks])
    statistic, freedom = np.zeros(len(blocks)), np.zeros(len(blocks), dtype=int)
    for w in np.unique(widths):
        alike = np.flatnonzero(widths == w)
        place = starts[alike][:, None] + np.arange(w)
        statistic[alike], freedom[alike] = batch(U[place], F[place[:, :, None], place[:, None, :]])
    return statistic, freedom


def batch(U: Array, F: Array) -> tuple[Array, Array]:
    """(H,) χ² and (H,) degrees of freedom of H candidates; ``U`` (H, w), ``F`` (H, w, w), any units.

    An amplitude of its own has `FAINT` of the trace, its square of the information.
    """
    scale = scale_of(F)
    turn, freedom = eigen_whitening(F * scale[:, :, None] * scale[:, None, :], scale > 0, FAINT)
    return ((((U * scale)[:, None, :] @ turn)[:, 0]) ** 2).sum(axis=1), freedom


def eigen_whitening(alike: Array, shown: Array, faint: float) -> tuple[Array, Array]:
    """(S, q, q) orthonormal directions of columns with the products ``alike`` (S, q, q), each of norm one, zero where a
    direction has not the share ``faint`` of the strongest, and (S,) int how many have; ``shown`` (S, q) bool."""
    size, turn = (alike[:, 0], np.ones_like(alike)) if alike.shape[-1] == 1 else eigh(alike)
    live = (size > faint**2 * size[:, -1:]) & shown.any(axis=1, keepdims=True)
    inverse = np.where(live, 1 / np.sqrt(np.where(live, size, 1.0)), 0.0)
    return turn * inverse[:, None, :], live.sum(axis=1)


def beside(blocks: Sequence[Block], U: Array, F: Array, found: Sequence[int]) -> tuple[Array, Array]:
    """The χ² and degrees of freedom of every block given the blocks ``found``; 0 of these."""
    if not found:
        return eigen_scores(blocks, U, F)
    starts = starts_of(blocks)
    absorbed = np.concatenate([np.arange(starts[k], starts[k + 1]) for k in found])
    statistic, freedom = eigen_scores(blocks, *given(U, F, absorbed, LEFT))
    statistic[list(found)] = 0.0
    return statistic, freedom


def shrinkage(statistic: Array, q: Array, freedom: Array) -> Array:
    """(S,) at most 1: by how much scores with χ² ``statistic`` of q amplitudes are as unlikely as normal ones.

    freedom : (S,) degrees of freedom from which their noise is estimated; infinite where it is stated.
    """
    known = np.isinf(freedom)
    energy = np.where(known, np.nan, np.maximum(np.where(known, 1.0, freedom) - statistic, 1e-3))
    normal = equivalent_chi2(statistic, q, energy, np.where(known, 1.0, freedom - q))
    return np.sqrt(np.where(statistic > 0, np.minimum(normal / np.where(statistic > 0, statistic, 1.0), 1.0), 1.0))
