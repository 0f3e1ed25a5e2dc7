"""The course of the applied vector on a diagnosis page: in words, drawn, and as a table."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.results import Course, Structure
from estimator.results import Residuals
from service.charts import ChartSet
from service.charts.course import course_charts, measure_of
from service.pages.residual_table import ResidualTable, rows_of
from service.words.structures import course_in_words


@dataclass(frozen=True)
class CourseView:
    """One course, for people."""

    words: str
    runs: bool
    """Whether the session has two runs to tell apart."""
    charts: tuple[ChartSet, ...]
    table: ResidualTable


def course_views(structures: Sequence[Structure], residuals: Residuals) -> tuple[CourseView, ...]:
    """Every course that can be drawn; one without components is told in words alone."""
    courses = [s.course for s in structures if s.course is not None and s.course.components]
    return tuple(_view(course, residuals, f"course-{number}") for number, course in enumerate(courses, 1))


def _view(course: Course, residuals: Residuals, name: str) -> CourseView:
    measures = [measure_of(course, component) for component in course.components]
    shown = np.array(course.values) * [measure.factor for measure in measures]
    return CourseView(
        words=course_in_words(course),
        runs=residuals.flipped is not None,
        charts=course_charts(course, residuals, name),
        table=ResidualTable(
            heads=tuple(f"{c}, {m.label}" for c, m in zip(course.components, measures, strict=True)),
            beta=residuals.beta is not None,
            rows=rows_of(shown, residuals),
        ),
    )
