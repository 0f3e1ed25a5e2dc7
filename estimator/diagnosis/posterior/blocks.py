"""Terms of a few columns each that touch all readings: the applied vector, a kind of sensor, all parameters of one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.term import CauseEffect, ListedTerms, Place, Term, UnknownCourse
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class TermColumns:
    """Columns at any size."""

    place: Place
    W: Array
    """(D, q) per unit of size."""
    log_prior: float
    """ln prior odds, all sizes together."""
    effect: CauseEffect | None = None
    course: UnknownCourse | None = None


class ColumnBlocks(ListedTerms):
    """A list of columns, each at every one of L sizes."""

    def __init__(self, blocks: Sequence[TermColumns], sizes: Array) -> None:
        """``sizes`` (L,), in the unit of the columns."""
        self.blocks, self.sizes = tuple(blocks), sizes
        super().__init__([block.place for block in blocks for _ in sizes])

    def weighed(self, info: InputInformation) -> Array:
        if not self.blocks:
            return np.zeros(0)
        each = np.split(info.A @ self.together, np.cumsum([b.W.shape[1] for b in self.blocks])[:-1], axis=1)
        values = [
            info.log_evidence_of((b.W.T @ AW)[None], (info.a @ b.W)[None], self.sizes)[0] + b.log_prior
            for b, AW in zip(self.blocks, each, strict=True)
        ]
        return np.concatenate(values) - np.log(len(self.sizes))

    @property
    def together(self) -> Array:
        """(D, Σq) all columns."""
        return np.concatenate([block.W for block in self.blocks], axis=1)

    def term(self, k: int) -> Term:
        block, size = self.blocks[k // len(self.sizes)], self.sizes[k % len(self.sizes)]
        prior, variance = block.log_prior - float(np.log(len(self.sizes))), np.full(block.W.shape[1], size**2)
        return Term(block.place, block.W, variance, prior, self.named, effect=block.effect, course=block.course)
