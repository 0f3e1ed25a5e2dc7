"""An unknown course of one sensor's zero, along any order of the rows."""

from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.kernels import (
    USUAL,
    along_each,
    common_kernels,
    common_waves,
    own_orders,
    root,
    waves,
)
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.priors import OWN_COURSE, SIZES
from estimator.diagnosis.posterior.term import COURSE, ListedTerms, Term, UnknownCourse
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class CourseFamily:
    """Courses of one sensor, all of a kernel or all waves. K courses."""

    sensor: int
    orders: tuple[str, ...]
    """(K,)"""
    roots: Array
    """(K, R, r) of mean variance one, padded with zeros."""
    log_prior: Array
    """(K, 1) ln prior odds of one size."""


class OwnCourses(ListedTerms):
    """Every sensor's own courses, half of the prior on those of a kernel and half on waves."""

    named = False

    def __init__(self, residuals: WhitenedResiduals) -> None:
        self.layout, setting = InputLayout.of(residuals), residuals.baseline.setting
        smooth = [(order, root(kernel)) for order, kernel in common_kernels(setting)]
        turning = list(common_waves(setting))
        self.families: list[CourseFamily] = []
        for i in range(self.layout.m):
            own = own_orders(setting, i)
            smooth_too = [(order, root(kernel)) for order, kernel in along_each(own)]
            self.families += [self.family(i, smooth + smooth_too), self.family(i, [*turning, *waves(own)])]
        super().__init__(
            [(COURSE, (family.sensor,)) for family in self.families],
            [len(family.orders) * len(SIZES) for family in self.families],
        )

    def family(self, i: int, courses: list[tuple[str, Array]]) -> CourseFamily:
        """Courses of sensor i by their orders and roots (R, r); those of an order share its prior."""
        orders = tuple(order for order, _ in courses)
        roots = np.zeros((len(courses), self.layout.R, max(L.shape[1] for _, L in courses)))
        for (_, L), whole in zip(courses, roots, strict=True):
            whole[:, : L.shape[1]] = L
        usual = [order if order in USUAL else "β" for order in orders]
        share = np.array([USUAL[order] / usual.count(order) for order in usual])
        share /= 2 * sum(USUAL[order] for order in set(usual))
        return CourseFamily(i, orders, roots, np.log(OWN_COURSE / self.layout.m / len(SIZES) * share)[:, None])

    def weighed(self, info: InputInformation) -> Array:
        values = []
        for family in self.families:
            at = self.layout.readings(family.sensor)
            A, a = info.A[np.ix_(at, at)], info.a[at]
            gram, along = family.roots.swapaxes(1, 2) @ (A @ family.roots), a @ family.roots
            sizes = SIZES * self.layout.unit[family.sensor]
            values.append((info.log_evidence_of(gram, along, sizes) + family.log_prior).ravel())
        return np.concatenate(values)

    def term(self, k: int) -> Term:
        group, within = self.located(k)
        family, (number, level) = self.families[group], divmod(within, len(SIZES))
        L = family.roots[number]
        L = L[:, np.abs(L).max(axis=0) > 0]
        variance = np.full(L.shape[1], (SIZES[level] * self.layout.unit[family.sensor]) ** 2)
        columns, course = self.layout.on_sensor(family.sensor, L), UnknownCourse(family.orders[number])
        prior = float(family.log_prior[number, 0])
        return Term((COURSE, (family.sensor,)), columns, variance, prior, named=False, course=course)
