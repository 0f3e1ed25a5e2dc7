"""A term of the model, and the contract of a kind of terms."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto
from functools import partial
from typing import ClassVar

import numpy as np

from estimator.causes.contract import Signature
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.priors import FURTHER
from estimator.session import Array

Place = tuple[str, tuple[int, ...]]
"""A name and the numbers of its sensors, none where it acts on none in particular: the thing that is weighed."""

COURSE, NOISE, MOVED = "unexplained", "excess-noise", "own-change"
"""Names of what is no cause of the catalogue: an unknown course, noise larger than stated, an unknown change."""


class Since(Enum):
    """Since when an effect acts."""

    BEFORE = auto()
    """Since before the history."""
    NOW = auto()
    """In this session alone."""
    OPEN = auto()
    """Left open, with what the sensor's parameters changed since the history."""


@dataclass(frozen=True, eq=False)
class CauseEffect:
    """A cause of the catalogue with its shape. q amplitudes."""

    cause: Signature
    nonlinear: tuple[float, ...]
    """Values of the nonlinear parameters, in the order of `Cause.nonlinear_units`."""
    since: Since
    scale: Array
    """(q,) amplitude, in the cause's SI unit, of a unit of each column; one of every sensor where several share it."""


@dataclass(frozen=True, eq=False)
class UnknownCourse:
    """An unknown course. R rows, c components."""

    order: str
    """The order of the rows along which it runs."""
    components: tuple[str, ...] = ()
    """The components of the applied vector that change, in words; none of a sensor's own course."""
    lift: Array | None = None
    """(c, R, q) the course of each component, rad or relative, per unit of each column; None of a sensor's own."""


@dataclass(frozen=True, eq=False)
class Term:
    """Something that may act in a session: x = W·(μ + u), u ~ N(0, V)."""

    place: Place
    columns: Array
    """(D, q) W, m/s² (rad/s) per unit; of what the history absorbed dimensionless."""
    variance: Array
    """(q,) V."""
    log_prior: float
    """ln prior odds of this name, place, shape and size."""
    named: bool
    """Whether it is a cause of the catalogue."""
    mean: Array | None = None
    """(q,) μ; None where it is zero."""
    effect: CauseEffect | None = None
    course: UnknownCourse | None = None
    log_place: float = 0.0
    """ln of the posterior odds of all shapes and sizes at its place over its own, where it was found."""

    @property
    def name(self) -> str:
        return self.place[0]

    @property
    def sensors(self) -> tuple[int, ...]:
        return self.place[1]


@dataclass(frozen=True, eq=False)
class PlaceCandidate:
    """A place with the ln posterior odds of all its terms together against none, and the likeliest of them."""

    place: Place
    value: float
    best: float
    """ln posterior odds of the likeliest term alone."""
    named: bool
    """Whether it is a cause of the catalogue."""
    make: Callable[[], Term]
    """Makes the likeliest term by itself."""

    def term(self) -> Term:
        """The likeliest term."""
        return replace(self.make(), log_place=self.value - self.best)

    def beside_others(self) -> "PlaceCandidate":
        """The candidate where something else is known to have happened in the same session."""
        return replace(self, value=self.value + FURTHER, best=self.best + FURTHER)


class Kind(ABC):
    """A kind of terms: weighs all of them at once, and makes those that are asked for."""

    @abstractmethod
    def candidates(self, info: InputInformation) -> list[PlaceCandidate]:
        """One for every place, beside what ``info`` holds already."""


class ListedTerms(Kind):
    """A kind whose terms can be listed beforehand, group by group. K terms at J places."""

    named: ClassVar[bool] = True
    """Whether its terms are causes of the catalogue."""

    def __init__(self, places: Sequence[Place], counts: Sequence[int]) -> None:
        """``places`` of the groups, the same one any number of times, and ``counts`` of their terms."""
        number: dict[Place, int] = {}
        of_group = np.array([number.setdefault(place, len(number)) for place in places], dtype=int)
        of_term = np.repeat(of_group, counts)
        self.ends_of_groups = np.cumsum(counts)
        self.places = tuple(number)
        self.order = np.argsort(of_term, kind="stable")
        self.first = np.flatnonzero(np.diff(of_term[self.order], prepend=-1))

    @abstractmethod
    def weighed(self, info: InputInformation) -> Array:
        """(K,) ln posterior odds of each term against none, beside what ``info`` holds already."""

    @abstractmethod
    def term(self, k: int) -> Term:
        """The k-th term."""

    def located(self, k: int) -> tuple[int, int]:
        """The group of the k-th term, and its number there."""
        group = int(np.searchsorted(self.ends_of_groups, k, side="right"))
        return group, k - (int(self.ends_of_groups[group - 1]) if group else 0)

    def candidates(self, info: InputInformation) -> list[PlaceCandidate]:
        if not self.places:
            return []
        value = self.weighed(info)[self.order]
        together = np.logaddexp.reduceat(value, self.first).tolist()
        ends = np.append(self.first[1:], len(value))
        best = [lo + int(np.argmax(value[lo:hi])) for lo, hi in zip(self.first, ends, strict=True)]
        return [
            PlaceCandidate(place, total, float(value[k]), self.named, partial(self.term, int(self.order[k])))
            for place, total, k in zip(self.places, together, best, strict=True)
        ]
