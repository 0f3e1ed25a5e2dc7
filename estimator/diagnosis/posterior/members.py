"""The sensors that follow a shared course.

Every set of k out of m sensors is as likely as any other of its number, and every number as any other. Sensors hardly
overlap, so that the likeliest sets are those with the largest evidence of each sensor alone; the best of them is then
weighed exactly, and members are added and dropped as long as that gains.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaln

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.priors import SIZES
from estimator.session import Array


def log_sets(m: int) -> Array:
    """(m,) ln of the share of one set of k out of m sensors, k = 1 … m."""
    k = np.arange(1, m + 1)
    return np.asarray(gammaln(k + 1) + gammaln(m - k + 1) - gammaln(m + 1) - np.log(m))


def each_alone(along: Array, square: Array) -> Array:
    """(L, …) ln B of single columns at every size, from W'a and W'AW (…), as if none overlapped."""
    g, square = SIZES.reshape(-1, *(1,) * along.ndim) ** 2, np.maximum(square, 0.0)
    return np.asarray(0.5 * g * along**2 / (1 + g * square) - 0.5 * np.log1p(g * square))


def likeliest_few(each: Array, fewest: int) -> Array:
    """(…) ln B of the likeliest set of at least ``fewest`` of m sensors, its share among all sets in it, from that of
    each alone (…, m)."""
    value = np.cumsum(-np.sort(-each, axis=-1), axis=-1) + log_sets(each.shape[-1])
    return np.asarray(value[..., fewest - 1 :].max(axis=-1))


@dataclass(frozen=True, eq=False)
class CourseMembers:
    """The likeliest set of sensors of a course."""

    value: float
    """ln B, the share of the set and of the size in it."""
    numbers: tuple[int, ...]
    level: int
    """Index in `SIZES`."""
    log_share: float
    """ln of the share of the set and of the size."""


def members_of(info: InputInformation, gram: Array, along: Array, fewest: int = 2) -> CourseMembers:
    """The likeliest set for one course on m sensors: W'AW (m, m) and W'a (m,) of its columns, a unit of size each."""
    m = len(along)
    sets = log_sets(m) - np.log(len(SIZES))

    def exact(some: Sequence[int]) -> CourseMembers:
        each = info.log_evidence_of(gram[np.ix_(some, some)][None], along[list(some)][None], SIZES)[0]
        level, share = int(np.argmax(each)), float(sets[len(some) - 1])
        return CourseMembers(float(each[level]) + share, tuple(sorted(some)), level, share)

    each = each_alone(along, np.diagonal(gram))
    order = np.argsort(-each, axis=1, kind="stable")
    value = np.cumsum(np.take_along_axis(each, order, axis=1), axis=1) + sets
    value[:, : fewest - 1] = -np.inf
    level, last = np.unravel_index(int(np.argmax(value)), value.shape)
    best = exact(order[level, : last + 1].tolist())
    for _ in range(m):
        rivals = [[x for x in best.numbers if x != i] if i in best.numbers else [*best.numbers, i] for i in range(m)]
        weighed = [exact(some) for some in rivals if len(some) >= fewest]
        rival = max(weighed, key=lambda one: one.value, default=best)
        if rival.value <= best.value:
            break
        best = rival
    return best if is_of_several(best, [exact([i]) for i in best.numbers]) else replace(best, value=-np.inf)


def is_of_several(best: CourseMembers, alone: Sequence[CourseMembers]) -> bool:
    """Whether a set explains more than any one of its sensors does: else that one has the course, and no other."""
    return best.value - best.log_share > max(one.value - one.log_share for one in alone)
