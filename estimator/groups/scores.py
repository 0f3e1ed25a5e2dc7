"""Scores of candidates from their score vector and information alone: no residuals are needed any more."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.signatures.directions import eigen_whitening
from estimator.diagnosis.signatures.scores import FAINT
from estimator.groups.statistics import Block
from estimator.least_squares import given
from estimator.session import Array

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
        own = np.flatnonzero(widths == w)
        place = starts[own][:, None] + np.arange(w)
        statistic[own], freedom[own] = batch(U[place], F[place[:, :, None], place[:, None, :]])
    return statistic, freedom


def batch(U: Array, F: Array) -> tuple[Array, Array]:
    """(H,) χ² and (H,) degrees of freedom of H candidates; ``U`` (H, w), ``F`` (H, w, w), any units.

    What counts as an amplitude of its own is what counts within one session: `FAINT` of the trace, its square of the
    information.
    """
    size = np.sqrt(np.maximum(np.diagonal(F, axis1=1, axis2=2), 0.0))
    scale = np.where(size > 0, 1 / np.where(size > 0, size, 1.0), 0.0)
    turn, freedom = eigen_whitening(F * scale[:, :, None] * scale[:, None, :], size > 0, FAINT)
    return ((((U * scale)[:, None, :] @ turn)[:, 0]) ** 2).sum(axis=1), freedom


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
        statistic, freedom = eigen_scores(self.blocks, *given(self.U, self.F, own, LEFT))
        statistic[list(found)] = 0.0
        return statistic, freedom
