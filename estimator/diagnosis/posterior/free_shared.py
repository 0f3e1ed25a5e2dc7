"""A course without a formula that several sensors share: the temperature of a room, a supply that wanders."""

from functools import partial

import numpy as np

from estimator.causes.shared import KINDS, SharedCourse, of_kind
from estimator.diagnosis.posterior.free_course import FreeCourse
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.members import CourseMembers, members_of
from estimator.diagnosis.posterior.priors import SHARED, SIZES
from estimator.diagnosis.posterior.shared_causes import PREFIX
from estimator.diagnosis.posterior.term import CauseEffect, Kind, PlaceCandidate, Since, Term
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array

FEWEST = 3
"""Sensors that must share a course without a formula: of two, either may as well have one of its own."""


class FreeShared(Kind):
    """The likeliest course of the leading waves of a walk, or of a rate that walks."""

    def __init__(self, residuals: WhitenedResiduals) -> None:
        self.layout = InputLayout.of(residuals)
        self.sigma = float(np.sqrt(np.median(residuals.baseline.variance / self.layout.unit**2)))
        self.waves = [law(self.layout.R) for law in KINDS]
        self.log_prior = float(np.log(SHARED / len(KINDS)))

    def candidates(self, info: InputInformation) -> list[PlaceCandidate]:
        R, m, unit = self.layout.R, self.layout.m, self.layout.unit
        if m < FEWEST:
            return []
        A = info.A[: R * m, : R * m].reshape(R, m, R, m) * unit[:, None, None] * unit
        a = info.a[: R * m].reshape(R, m) * unit
        found = []
        for kind, w in enumerate(self.waves):
            gram = np.einsum("rimj,ra,mb->iajb", A, w, w, optimize=True)
            course = FreeCourse.of_products(gram * self.sigma**2, np.einsum("rm,ra->ma", a, w) * self.sigma)
            h = w @ course.waves
            h = h / max(float(np.abs(h).max()), 1e-300)
            members = members_of(info, np.einsum("rimj,r,m->ij", A, h, h, optimize=True), a.T @ h, FEWEST)
            prior = self.log_prior - float(np.log(course.tried))
            value, place = members.value + prior, (PREFIX + SharedCourse.identifier, members.numbers)
            make = partial(self.term, kind, course.waves, members, prior)
            found.append(PlaceCandidate(place, value, value, True, make))
        return [max(found, key=lambda c: c.value)]

    def term(self, kind: int, sizes: Array, members: CourseMembers, log_prior: float) -> Term:
        """The course of waves of some sizes (w,) on some sensors."""
        course = self.waves[kind] @ sizes
        peak = max(float(np.abs(course).max()), 1e-300)
        unit = self.layout.unit[list(members.numbers)]
        each = [self.layout.on_sensor(i, course[:, None] / peak * self.layout.unit[i]) for i in members.numbers]
        effect = CauseEffect(SharedCourse(), of_kind(kind, sizes), Since.NOW, unit / peak)
        variance = np.full(len(unit), SIZES[members.level] ** 2)
        place = (PREFIX + SharedCourse.identifier, members.numbers)
        W = np.concatenate(each, axis=1)
        return Term(place, W, variance, log_prior + members.log_share, named=True, effect=effect)
