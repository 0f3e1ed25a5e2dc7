"""Terms of a few columns each that touch all readings: the applied vector, a kind of sensor, all parameters of one."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

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
        self.blocks = tuple(sorted(blocks, key=lambda block: block.W.shape[1]))
        self.sizes = sizes
        super().__init__([block.place for block in self.blocks], [len(sizes)] * len(self.blocks))

    def weighed(self, info: InputInformation) -> Array:
        if not self.blocks:
            return np.zeros(0)
        moved, along = np.split(info.A @ self.together, self.ends, axis=1), np.split(info.a @ self.together, self.ends)
        values = []
        for _, numbers in groupby(range(len(self.blocks)), key=lambda k: self.blocks[k].W.shape[1]):
            alike = list(numbers)
            gram = np.stack([self.blocks[k].W.T @ moved[k] for k in alike])
            values.append(info.log_evidence_of(gram, np.stack([along[k] for k in alike]), self.sizes))
        prior = np.array([block.log_prior for block in self.blocks])[:, None] - np.log(len(self.sizes))
        return np.asarray((np.concatenate(values) + prior).ravel())

    @cached_property
    def together(self) -> Array:
        """(D, Σq) all columns."""
        return np.concatenate([block.W for block in self.blocks], axis=1)

    @cached_property
    def ends(self) -> Array:
        """Columns at which every block but the first begins."""
        return np.cumsum([block.W.shape[1] for block in self.blocks])[:-1]

    def term(self, k: int) -> Term:
        block, size = self.blocks[k // len(self.sizes)], self.sizes[k % len(self.sizes)]
        prior, variance = block.log_prior - float(np.log(len(self.sizes))), np.full(block.W.shape[1], size**2)
        return Term(block.place, block.W, variance, prior, self.named, effect=block.effect, course=block.course)
