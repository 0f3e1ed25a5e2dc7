"""How the applied vector must have run, a panel a component: by angle or in the order measured."""

from functools import cache
from typing import Any

import altair as alt
import numpy as np

from estimator.diagnosis.results import Course
from estimator.results import Residuals
from estimator.session import ACCELEROMETER
from service.charts import DATA_FORM, HIGH, LEFT, LOW, RIGHT, UNIT, ChartSet, Panel, filled, padded, specification
from service.charts.across import (
    BETA,
    BETA_RANGE,
    HEIGHT,
    RUNS,
    SHAPES,
    Across,
    by_angle,
    in_order,
    ticks,
    zero_line,
)
from service.measures import THIN, Measure, decimals, deviation_measure, number
from service.words.structures import SIZE, component_in_words

CHANGE = "{change}"
"""Blank: the name of the tooltip's number, with its unit."""


def course_charts(course: Course, residuals: Residuals, name: str) -> tuple[ChartSet, ...]:
    """One set a unit: angles share one, the size has its own; none where the whole vector changed once."""
    across = across_of(course, residuals)
    angles = [k for k, component in enumerate(course.components) if component != SIZE]
    sizes = [k for k, component in enumerate(course.components) if component == SIZE]
    kinds = [(f"{name}-{label}", columns) for label, columns in (("angle", angles), ("size", sizes)) if columns]
    return tuple(_chart_set(course, residuals, across, label, columns) for label, columns in kinds)


def across_of(course: Course, residuals: Residuals) -> Across:
    """Along β where the course is smooth along it, else in the order measured."""
    angle = by_angle(residuals) if course.order.startswith("β") else None
    return in_order(residuals) if angle is None else angle


def measure_of(course: Course, component: str) -> Measure:
    """Of what changes: an angle, or relative; components of one unit share it."""
    is_size = component == SIZE
    values = [
        abs(row[k]) for row in course.values for k, one in enumerate(course.components) if (one == SIZE) == is_size
    ]
    return deviation_measure(ACCELEROMETER, "scale" if is_size else "axis", max(values, default=0.0))


def _chart_set(course: Course, residuals: Residuals, across: Across, name: str, columns: list[int]) -> ChartSet:
    measure = measure_of(course, course.components[columns[0]])
    value = np.array(course.values)[:, columns] * measure.factor
    largest = float(np.max(np.abs(value), initial=0.0, where=np.isfinite(value)))
    is_joined = not course.order.startswith("no order")
    return ChartSet(
        name=name,
        heading=across.heading,
        spec=_filled(across, measure, largest, is_joined=is_joined),
        panels=tuple(
            _panel(course.components[k], value[:, place], residuals, across, measure) for place, k in enumerate(columns)
        ),
    )


def _panel(component: str, value: np.ndarray, residuals: Residuals, across: Across, measure: Measure) -> Panel:
    known = value[np.isfinite(value)]
    reach = float(np.abs(known).max(initial=0.0))
    return Panel(
        title=component,
        description=f"{component_in_words(component)}, up to {number(reach, decimals(reach))}{THIN}{measure.label}",
        condition=None,
        datasets={DATA_FORM: _points(value, residuals, across)},
    )


def _points(value: np.ndarray, residuals: Residuals, across: Across) -> list[dict[str, Any]]:
    flipped = residuals.flipped
    return [
        {
            "x": float(f"{across.values[row]:.6g}"),
            "y": float(f"{value[row]:.5g}"),
            "run": RUNS[0] if flipped is None else RUNS[int(flipped[row])],
            "row": row + 1,
        }
        for row in range(min(len(value), len(across.values)))
        if np.isfinite(value[row])
    ]


def _filled(across: Across, measure: Measure, largest: float, *, is_joined: bool) -> dict[str, Any]:
    left, right = BETA_RANGE if across.name == BETA else (0, len(across.values) + 1)
    low, high = padded(-largest, largest)
    blanks = {LEFT: left, RIGHT: right, LOW: low, HIGH: high, UNIT: measure.label}
    spec = _spec(across.name, across.title, is_joined=is_joined)
    found: dict[str, Any] = filled(spec, {**blanks, CHANGE: f"off by, {measure.label}"})
    return found


@cache
def _spec(name: str, title: str, *, is_joined: bool) -> dict[str, Any]:
    """With blanks for the unit and the ranges; ``is_joined``: neighbours are joined by a line."""
    x = alt.X("x:Q", title=title, axis=alt.Axis(**ticks(name)), scale=alt.Scale(domain=[LEFT, RIGHT], nice=False))
    y = alt.Y("y:Q", title=UNIT, axis=alt.Axis(tickCount=5), scale=alt.Scale(domain=[LOW, HIGH]))
    colour = alt.Color("run:N", legend=None, scale=alt.Scale(domain=RUNS, range=["var(--accent)", "var(--second)"]))
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x, y=y, color=colour)
    lines = [base.mark_line(strokeWidth=1, opacity=0.6)] if is_joined else []
    return specification([zero_line(), *lines, _marks(base)], HEIGHT)


def _marks(base: alt.Chart) -> alt.Chart:
    chart: alt.Chart = base.mark_point(filled=True, opacity=1, size=36, stroke="var(--card)", strokeWidth=0.5).encode(
        shape=alt.Shape("run:N", legend=None, scale=SHAPES),
        tooltip=[
            alt.Tooltip("row:Q", title="row"),
            alt.Tooltip("run:N", title="run"),
            alt.Tooltip("y:Q", title=CHANGE),
        ],
    )
    return chart
