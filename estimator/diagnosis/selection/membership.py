"""Finds the sensors that follow a course which a group of them shares, with the certainty of each.

Theory
------
The course is given; only the sizes are open, one a sensor, and all that is sought is linear in them. Let A = X'X be of
the sensors' whitened traces along it, each of length one, and y = X'z. Sizes that are N(0, g) give a set S of k sensors

    ln p(S) = ½ y'(A + I/g)⁻¹y − ½ ln|I + g·A| + ln p(k),        mean over g

The set lies in a group: all sensors, or those of one kind. Every group is equally likely, in one of n sensors every k
from 1 to n, and every set of k: p(k) = 1/(n·C(n, k)) over the number of groups. No number of sensors is the likeliest
beforehand, and all of a group cost no more than one.

With P = (A + I/g)⁻¹ of the set, sensor c joins or leaves it with the change of ln p (block inversion)

    joins:  ½ u²/s − ½ ln(g·s),   s = A_cc + 1/g − a'Pa,   u = y_c − a'Py          (a: column c of A, rows of the set)
    leaves: −½ (Py)_c²/P_cc + ½ ln(g/P_cc)

so that a step costs one inversion a size for all sensors together. A sensor's first two terms, without those of p(k),
are what the readings say for its own size, given the course and all others: it is named where that is odds of nineteen,
and else it follows below what can be named alone. That most others follow is odds of k that it does too, whatever it
reads, so that it may be counted with them, but not be named for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import gammaln

from estimator.session import Array

SURE = float(np.log(19))
"""ln odds by which a sensor is named as following a course: one in twenty that it is a bystander."""

SIZES = 4.0 ** np.arange(1, 9)
"""g: mean square sizes of a course's sensors, standard errors, from 2 to 256 of them; all equally likely."""


@dataclass(frozen=True, eq=False)
class CauseMembers:
    """Sensors that share a course, by their numbers among those that may."""

    chosen: tuple[int, ...]
    sure: tuple[int, ...]
    """The chosen sensors that can be named alone."""
    log_evidence: float
    """ln evidence against no course."""
    alone: float
    """ln evidence of the likeliest single sensor."""

    @property
    def are_several(self) -> bool:
        """Whether several sensors share the course rather than one having it alone."""
        return len(self.chosen) > 1 and self.log_evidence - self.alone > SURE


@dataclass(frozen=True, eq=False)
class Loadings:
    """Response of the sensors along a course. k sensors that may follow it."""

    gram: Array
    """(k, k) products of their traces, each of length one."""
    along: Array
    """(k,) products of the traces with the residuals, standard errors."""
    kinds: tuple[str, ...]
    """(k,) kinds of the sensors."""
    counts: dict[str, int]
    """Sensors of every kind in the block."""

    def members(self) -> CauseMembers:
        """The likeliest set.

        It is climbed to from none and from all: where what sensors show overlaps, one of them may show what others do,
        and many together what none does alone.
        """
        everyone = tuple(range(len(self.along)))
        climbed = [self.climbed(begun) for begun in ((), everyone)]
        chosen, value = max(climbed, key=lambda result: result[1])
        readings, whole = self.likelihoods(chosen)
        sure = tuple(c for c in chosen if whole - readings[c] > SURE)
        return CauseMembers(chosen, sure, value, float(self.steps(())[0].max()))

    def climbed(self, begun: tuple[int, ...]) -> tuple[tuple[int, ...], float]:
        """The set to which one sensor joining or leaving at a time leads, and its ln p."""
        chosen = begun
        while True:
            values, value = self.steps(chosen)
            best = int(np.argmax(values))
            if values[best] <= value + 1e-9:
                return chosen, value
            chosen = tuple(sorted({best} ^ set(chosen)))

    def steps(self, chosen: tuple[int, ...]) -> tuple[Array, float]:
        """(k,) ln p of the sets that differ from one by a sensor, and the ln p of that set itself."""
        likelihood, own = self.likelihoods(chosen)
        prior = [self.log_prior({c} ^ set(chosen)) for c in range(len(self.along))]
        return likelihood + prior, own + self.log_prior(set(chosen))

    def likelihoods(self, chosen: tuple[int, ...]) -> tuple[Array, float]:
        """(k,) ln p of the sets that differ by a sensor, and of the set itself, by the readings alone: without ln
        p(k).
        """
        inside = np.zeros(len(self.along), dtype=bool)
        inside[list(chosen)] = True
        A, y, cross = self.gram[np.ix_(inside, inside)], self.along[inside], self.gram[inside]
        P = np.linalg.inv(A + np.eye(len(y)) / SIZES[:, None, None])
        of_set = 0.5 * (y @ P @ y) - 0.5 * np.linalg.slogdet(np.eye(len(y)) + SIZES[:, None, None] * A)[1]
        moved = P @ cross
        spread = np.diagonal(self.gram) + 1 / SIZES[:, None] - (cross * moved).sum(axis=1)
        ahead = self.along - y @ moved
        change = 0.5 * ahead**2 / np.maximum(spread, 1e-12) - 0.5 * np.log(SIZES[:, None] * np.maximum(spread, 1e-12))
        own = np.diagonal(P, axis1=1, axis2=2)
        change[:, inside] = -0.5 * (P @ y) ** 2 / own + 0.5 * np.log(SIZES[:, None] / own)
        mean = np.logaddexp.reduce(of_set[:, None] + change, axis=0) - np.log(len(SIZES))
        return np.asarray(mean), float(np.logaddexp.reduce(of_set) - np.log(len(SIZES)))

    def log_prior(self, chosen: set[int]) -> float:
        """ln p(k) of a set; 0 of none, which is what all are held against."""
        return -log_sets(self.counts, {self.kinds[c] for c in chosen}, len(chosen)) if chosen else 0.0


def log_sets(counts: dict[str, int], kinds: set[str], k: int) -> float:
    """ln of the number of sets of ``k`` sensors, of some ``kinds``, that share the prior of all in the likeliest group.

    ``counts``: sensors of every kind in the block.
    """
    sizes = [sum(counts.values()), *([counts[next(iter(kinds))]] if len(kinds) == 1 < len(counts) else [])]
    groups = 1 + (len(counts) if len(counts) > 1 else 0)
    number = [np.log(n) + gammaln(n + 1) - gammaln(k + 1) - gammaln(n - k + 1) for n in sizes]
    return float(np.log(groups) + min(number))


def counts_of(kinds: Sequence[str]) -> dict[str, int]:
    """Sensors of every kind."""
    return {kind: list(kinds).count(kind) for kind in dict.fromkeys(kinds)}
