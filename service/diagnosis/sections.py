"""A diagnosis in one line, and the course of the applied vector, as sections of a page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.diagnosis import Finding
from estimator.diagnosis.results import Course, Shared, Structure
from estimator.message import say
from estimator.results import Calibration, Residuals
from service.diagnosis.charts import course_charts, measure_of, shared_chart
from service.diagnosis.words.findings import course_in_words
from service.kit.failure import session_failed
from service.kit.measures import COVERAGE, deviation_measure
from service.sessions.charts import ChartSet
from service.sessions.lines import ResidualTable, rows_of
from service.sessions.records import DiagnosisState, DiagnosisSummary

PENDING = "Still being examined"
TONES = {
    DiagnosisState.NOTHING: "pass",
    DiagnosisState.NAMED: "conditional-fail",
    DiagnosisState.UNDECIDED: "undecidable",
    DiagnosisState.UNEXPLAINED: "undecidable",
    DiagnosisState.FAILED: "none",
    DiagnosisState.NOT_APPLICABLE: "none",
}
"""Style and icon, in the tones of the verdicts: how much it asks for attention."""


@dataclass(frozen=True)
class DiagnosisLine:
    """Diagnosis in one line."""

    tone: str
    text: str
    gain: str = ""
    """Gain from the named causes, in one sentence."""


def diagnosis_line(found: DiagnosisSummary | None, failed: str = "") -> DiagnosisLine:
    """The line of a diagnosis; pending while ``found`` is None, unless it ``failed``."""
    if found is None and failed:
        return DiagnosisLine(TONES[DiagnosisState.FAILED], session_failed(failed))
    return (
        DiagnosisLine("none", PENDING)
        if found is None
        else DiagnosisLine(TONES[found.state], found.summary, found.gain)
    )


@dataclass(frozen=True)
class CourseView:
    """One course, for people."""

    words: str
    runs: bool
    """Whether the session has two runs to tell apart."""
    charts: tuple[ChartSet, ...]
    table: ResidualTable


def course_views(structures: Sequence[Structure], residuals: Residuals) -> tuple[CourseView, ...]:
    """Every course that can be drawn; one without components is described in words alone."""
    courses = [s.course for s in structures if s.course is not None and s.course.components]
    return tuple(_view(course, residuals, f"course-{number}") for number, course in enumerate(courses, 1))


@dataclass(frozen=True)
class SharedView:
    """The course of one finding, for people."""

    sensor: str
    """Sensor that shows it most."""
    chart: ChartSet
    table: ResidualTable


def shared_views(findings: Sequence[Finding], calibration: Calibration) -> tuple[SharedView | None, ...]:
    """The course of every finding in turn; None where its sensors share no course."""
    kinds = {sensor.name: sensor.kind for sensor in calibration.sensors}
    return tuple(
        None if f.shared is None else _shared(f.shared, kinds, calibration.residuals, f"shared-{number}")
        for number, f in enumerate(findings, 1)
    )


def _shared(shared: Shared, kinds: Mapping[str, str], residuals: Residuals, name: str) -> SharedView:
    kind = kinds[shared.drawn_for]
    columns = np.stack([shared.course, shared.measured, COVERAGE * np.array(shared.band)], axis=1)
    measure = deviation_measure(kind, "bias", float(np.max(np.abs(columns))))
    heads = ("the course", "all sensors together", "U")
    return SharedView(
        sensor=shared.drawn_for,
        chart=shared_chart(shared, kind, residuals, name),
        table=ResidualTable(
            heads=tuple(say("{heading}, {label}", heading=head, label=measure.label) for head in heads),
            beta=residuals.beta is not None,
            rows=rows_of(columns * measure.factor, residuals),
        ),
    )


def _view(course: Course, residuals: Residuals, name: str) -> CourseView:
    measures = [measure_of(course, component) for component in course.components]
    shown = np.array(course.values) * [measure.factor for measure in measures]
    return CourseView(
        words=course_in_words(course),
        runs=residuals.flipped is not None,
        charts=course_charts(course, residuals, name),
        table=ResidualTable(
            heads=tuple(
                say("{heading}, {label}", heading=c, label=m.label)
                for c, m in zip(course.components, measures, strict=True)
            ),
            beta=residuals.beta is not None,
            rows=rows_of(shown, residuals),
        ),
    )
