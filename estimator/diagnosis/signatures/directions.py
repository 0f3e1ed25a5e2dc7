"""Orthonormal directions of the columns of many signatures, from their inner products alone.

Theory
------
Columns of norm one with the products G = VΛV' have the orthonormal directions VΛ^(−½), of which those of a faint
eigenvalue count as none. Beside columns that many signatures share, with the products H and the root H⁻¹ = RR', one
column with the products h leaves 1 − h'H⁻¹h of its square. So the shared ones are decomposed once for all signatures.
"""

import numpy as np

from estimator.arrays import eigh
from estimator.session import Array

ALIKE = 1e-6
"""Share of its length that must lie outside the others' span for a column to count where none is to be left out: the
square lies well above rounding."""


def whitening(alike: Array, shown: Array, faint: float, group: Array | None) -> tuple[Array, Array]:
    """(S, q, q) orthonormal directions of columns, zero where one does not count, and (S,) int how many do.

    Parameters
    ----------
    alike : (S, q, q) products of the columns, each of norm one, dimensionless.
    shown : (S, q) bool: columns that count.
    faint : share of the strongest direction that one must have.
    group : (S,) int: signatures of one number share all columns but the first; None where they share none.
    """
    if group is None:
        return eigen_whitening(alike, shown, faint)
    turn, live = np.zeros_like(alike), np.full(len(alike), alike.shape[-1])
    clear = np.zeros(len(alike), dtype=bool)
    for number in np.unique(group):
        members = group == number
        turn[members], clear[members] = whitened_jointly(alike[members], faint)
    turn[~clear], live[~clear] = eigen_whitening(alike[~clear], shown[~clear], faint)
    return turn, live


def eigen_whitening(alike: Array, shown: Array, faint: float) -> tuple[Array, Array]:
    """Whitens the columns of each signature by their eigenvectors; returns the whitening and the directions that
    count.
    """
    size, turn = (alike[:, 0], np.ones_like(alike)) if alike.shape[-1] == 1 else eigh(alike)
    live = (size > faint**2 * size[:, -1:]) & shown.any(axis=1, keepdims=True)
    inverse = np.where(live, 1 / np.sqrt(np.where(live, size, 1.0)), 0.0)
    return turn * inverse[:, None, :], live.sum(axis=1)


def whitened_jointly(alike: Array, faint: float) -> tuple[Array, Array]:
    """(S, q, q) orthonormal directions of S first columns beside others, the same for all and projected out once; and
    (S,) bool whether surely all of them count: no eigenvalue is below one over the inverse's trace, nor above q."""
    S, q, _ = alike.shape
    size, turn = eigh(alike[0, 1:, 1:])
    root = turn / np.sqrt(np.maximum(size, ALIKE**2))
    along = alike[:, 0, 1:] @ root @ root.T
    independent = np.maximum(1.0 - (along * alike[:, 0, 1:]).sum(axis=1), ALIKE**2)
    turns = np.zeros((S, q, q))
    turns[:, 0, 0] = 1 / np.sqrt(independent)
    turns[:, 1:, 0] = -along / np.sqrt(independent)[:, None]
    turns[:, 1:, 1:] = root
    return turns, (alike[:, 0, 0] > 0) & (faint**2 * q * (turns**2).sum(axis=(1, 2)) < 1)
