"""An unknown course of the applied vector: an error of stand, fixture or reference that no cause describes.

Every sensor sees a change δn of the applied vector through its axis, e·δn: as a smooth course of up to three components
along some order, anew at every row, as a change that stays, or as a wave. No sensor's own fault hides there: half of
its energy lies in parity space.
"""

from collections.abc import Iterator

import numpy as np

from estimator.arrays import eigh
from estimator.causes.contract import Setting
from estimator.diagnosis.posterior.blocks import ColumnBlocks, TermColumns
from estimator.diagnosis.posterior.course_hypotheses import CourseHypothesis, components, hypotheses
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.kernels import HIGHEST, wave
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.priors import COMMON_COURSE, SIZES
from estimator.diagnosis.posterior.term import COURSE, UnknownCourse
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.message import say
from estimator.session import Array

SEEN = 5e-3
"""Share of the most visible direction of a course below which one counts as none."""


LOWEST = 3
"""Harmonic of β from which on a wave is no cause of the catalogue: eccentricity, wobble and bearing are the others."""


ALIKE = 0.1
"""Share of a wave's size below which what a cause leaves of it tells them apart by nothing but luck."""


class AppliedCourses(ColumnBlocks):
    """Courses of the applied vector, half of the prior on those of a kernel and half on waves."""

    named = False

    def __init__(self, residuals: WhitenedResiduals, start: InputInformation) -> None:
        """``start``: the information with nothing found."""
        setting, layout = residuals.baseline.setting, InputLayout.of(residuals)
        families = [[h for h in family if np.any(h.columns)] for family in (hypotheses(setting), waves(setting))]
        prior = [float(np.log(COMMON_COURSE / len(families) / max(len(family), 1))) for family in families]
        blocks = (block(layout, start, h, p) for family, p in zip(families, prior, strict=True) for h in family)
        super().__init__(list(blocks), SIZES)


def block(layout: InputLayout, start: InputInformation, course: CourseHypothesis, log_prior: float) -> TermColumns:
    """The columns of a course at a unit of size, directions that hardly show left out."""
    W = layout.whole(course.columns)
    peak = (np.sqrt((course.columns**2).sum(axis=-1)) / layout.unit).max()
    size, turn = eigh(W.T @ (start.A @ W))
    turn = turn[:, size > SEEN * size[-1]] / peak
    known = UnknownCourse(course.order, course.components, course.lift @ turn)
    return TermColumns((COURSE, ()), W @ turn, log_prior, course=known)


def waves(setting: Setting) -> Iterator[CourseHypothesis]:
    """Waves of the applied vector's turns around β, where they are no cause of the catalogue, and over the session."""
    if setting.beta is None:
        return
    place = np.arange(setting.rows) / setting.rows
    tried: list[tuple[str, Array]] = [
        (say("harmonic {shape} of β", shape=k), wave(setting.beta * k)) for k in range(LOWEST, HIGHEST + 1)
    ]
    known = np.concatenate([wave(setting.beta * k) for k in range(1, LOWEST)], axis=1)
    over_time = (wave(2 * np.pi * k * place) for k in range(1, setting.rows // 2))
    tried += [("the order measured", columns) for columns in over_time if not is_in(known, columns)]
    for order, columns in tried:
        for part in components(setting)[:2]:
            yield CourseHypothesis(order, (part.words,), part.columns[..., None] * columns[:, None, :], columns[None])


def is_in(known: Array, columns: Array) -> bool:
    """Whether columns (R, q) lie in the span of those that are ``known`` (R, k), as waves over the session do that is
    measured in even steps of β."""
    left = columns - known @ np.linalg.lstsq(known, columns, rcond=None)[0]
    return bool(np.linalg.norm(left) < ALIKE * np.linalg.norm(columns))
