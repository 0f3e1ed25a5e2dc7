"""Scores of candidates from their score vector and information alone: no residuals are needed any more."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.diagnosis.signatures.scores import FAINT
from estimator.groups.statistics import Block
from estimator.session import Array


def starts_of(blocks: Sequence[Block]) -> Array:
    """(B + 1,) int, dimensionless: first column of every block, and their number."""
    return np.concatenate([[0], np.cumsum([b.width for b in blocks])]).astype(int)


def eigen_scores(blocks: Sequence[Block], U: Array, F: Array) -> tuple[Array, Array]:
    """(B,) χ² and (B,) degrees of freedom of every block; ``U`` (D,) and ``F`` (D, D) in any units."""
    starts, widths = starts_of(blocks), np.array([b.width for b in blocks])
    statistic, freedom = np.zeros(len(blocks)), np.zeros(len(blocks), dtype=int)
    for w in np.unique(widths):
        own = np.flatnonzero(widths == w)
        place = starts[own][:, None] + np.arange(w)
        statistic[own], freedom[own] = batch(U[place], F[place[:, :, None], place[:, None, :]])
    return statistic, freedom


def batch(U: Array, F: Array) -> tuple[Array, Array]:
    """(H,) χ² and (H,) degrees of freedom of H candidates; ``U`` (H, w), ``F`` (H, w, w), any units.

    What counts as an amplitude of its own is what counts within one session: `FAINT` of the trace, its square of the
    information.
    """
    if U.shape[1] == 1:
        seen = F[:, 0, 0] > 0
        return np.where(seen, U[:, 0] ** 2 / np.where(seen, F[:, 0, 0], 1.0), 0.0), seen.astype(int)
    size = np.sqrt(np.maximum(np.diagonal(F, axis1=1, axis2=2), 0.0))
    scale = np.where(size > 0, 1 / np.where(size > 0, size, 1.0), 0.0)
    value, vector = eigh(F * scale[:, :, None] * scale[:, None, :])
    live = value > FAINT**2 * np.maximum(value[:, -1:], 1e-300)
    along = ((U * scale)[:, None, :] @ vector)[:, 0]
    return (np.where(live, along**2 / np.where(live, value, 1.0), 0.0)).sum(axis=1), live.sum(axis=1) * (
        value[:, -1] > 0
    )


def inverse(F: Array) -> Array:
    """(q, q) pseudo-inverse of an information (q, q) in any units, its faint directions left out."""
    size = np.sqrt(np.maximum(np.diagonal(F), 0.0))
    scale = np.where(size > 0, 1 / np.where(size > 0, size, 1.0), 0.0)
    value, vector = eigh(F * scale[:, None] * scale)
    live = value > 1e-6 * max(float(value[-1]), 1e-300) if len(value) else np.zeros(0, bool)
    part = vector[:, live]
    return np.asarray(scale[:, None] * (part / value[live]) @ part.T * scale)


@dataclass(frozen=True, eq=False)
class Scores:
    """Candidates of one session or pool. B blocks, D columns."""

    blocks: tuple[Block, ...]
    U: Array
    F: Array

    @classmethod
    def of(cls, blocks: Sequence[Block], U: Array, F: Array) -> "Scores":
        """With columns of norm one."""
        size = np.sqrt(np.diagonal(F))
        scale = np.where(size > 0, 1 / np.where(size > 0, size, 1.0), 0.0)
        return cls(tuple(blocks), U * scale, F * scale[:, None] * scale)

    def given(self, found: Sequence[int]) -> tuple[Array, Array]:
        """(B,) χ² and (B,) degrees of freedom of every block, given those ``found``; 0 of these."""
        if not found:
            return eigen_scores(self.blocks, self.U, self.F)
        starts = starts_of(self.blocks)
        own = np.concatenate([np.arange(starts[k], starts[k + 1]) for k in found])
        cross = self.F[:, own] @ inverse(self.F[np.ix_(own, own)])
        F = self.F - cross @ self.F[own]
        gone = np.diagonal(F) < 1e-4
        F[gone], F[:, gone] = 0.0, 0.0
        U = np.where(gone, 0.0, self.U - cross @ self.U[own])
        statistic, freedom = eigen_scores(self.blocks, U, F)
        statistic[list(found)] = 0.0
        return statistic, freedom
