"""Residuals before and after the causes are named, and the course of the applied vector."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from estimator.diagnosis.results import Course, Shared
from estimator.json_object import Json
from estimator.message import say
from estimator.results import Residuals, SensorCalibration
from estimator.session import ACCELEROMETER
from service.diagnosis.words.findings import SIZE, component_in_words
from service.kit.libraries import alt
from service.kit.measures import COVERAGE, THIN, Measure, decimals, deviation_measure, number
from service.sessions.charts import (
    BETA,
    BETA_RANGE,
    DATA_FORM,
    HEIGHT,
    RUNS,
    Across,
    ChartSet,
    Noise,
    Panel,
    by_angle,
    edges,
    filled,
    hints,
    in_order,
    largest_edge,
    padded,
    scatter_in_words,
    shapes,
    specification,
    ticks,
    x_scale,
    y_axis,
    y_scale,
    zero_line,
)

MOST_PANELS = 9
"""Sensors that are drawn one way of looking, three rows of three; the page says how many are left out."""
MODELS = ("before", "after")
"""Names of the models in the data, without the named causes and with them."""
CHANGE = "{change}"
"""Blank: the name of the tooltip's number, with its unit."""


@dataclass(frozen=True)
class Sides:
    """Residuals of all sensors under both models; after is None where nothing was named."""

    sensors: tuple[SensorCalibration, ...]
    before: Residuals
    after: Residuals | None
    noise: Noise


def diagnosis_charts(sides: Sides, named: Sequence[str]) -> tuple[ChartSet, ...]:
    """One set a way of looking and kind of sensor; the named sensors stand first, and of many only some are drawn.

    A sensor without residuals, as a gyro of an alignment, is not drawn.
    """
    drawn = np.flatnonzero(np.isfinite(sides.before.value).any(axis=0)).tolist()
    order = sorted(drawn, key=lambda i: (sides.sensors[i].name not in named, i))
    kinds = dict.fromkeys(sides.sensors[i].kind for i in order)
    return tuple(
        _chart_set(sides, across, [i for i in order if sides.sensors[i].kind == kind][:MOST_PANELS], len(kinds) > 1)
        for across in _ways(sides.before)
        for kind in kinds
    )


def _ways(residuals: Residuals) -> list[Across]:
    angle, time, temperature = by_angle(residuals), residuals.time, residuals.temperature
    found = [] if angle is None else [angle]
    found.append(in_order(residuals) if time is None else Across("time", "By time", "h", time / 3600))
    if temperature is not None and float(np.ptp(temperature)) > 0:
        found.append(Across("temperature", "By temperature", "°C", temperature))
    return found


def _chart_set(sides: Sides, across: Across, columns: list[int], several: bool) -> ChartSet:
    kind = sides.sensors[columns[0]].kind
    noise = sides.noise
    largest = largest_edge(sides.before.value[:, columns], noise.stated[:, columns], noise.found[:, columns])
    measure = deviation_measure(kind, "bias", largest)
    return ChartSet(
        name=f"diagnosis-{kind}-{across.name}",
        heading=say("{heading}, {kind}", heading=across.heading, kind=f"{kind}s") if several else across.heading,
        spec=_spec_of(across, measure, largest * measure.factor, wider=noise.times is not None),
        panels=tuple(_panel(sides, i, across, measure) for i in columns),
    )


def _panel(sides: Sides, column: int, across: Across, measure: Measure) -> Panel:
    shown = [_rms(side, column, measure) for side in (sides.before, sides.after) if side is not None]
    return Panel(
        title=sides.sensors[column].name,
        description=say(
            "rms {values}{thin_space}{label}", values=" → ".join(shown), thin_space=THIN, label=measure.label
        ),
        datasets={DATA_FORM: _points(sides, column, across, measure)},
    )


def _rms(side: Residuals, column: int, measure: Measure) -> str:
    value = side.value[:, column][np.isfinite(side.value[:, column])]
    return scatter_in_words(float(np.sqrt(np.mean(value**2))) if len(value) else 0.0, measure)


def _points(sides: Sides, column: int, across: Across, measure: Measure) -> list[Json]:
    models = [(MODELS[0], sides.before), *([] if sides.after is None else [(MODELS[1], sides.after)])]
    flipped = sides.before.flipped
    return [
        {
            "x": float(f"{across.values[row]:.6g}"),
            "y": float(f"{side.value[row, column] * measure.factor:.5g}"),
            "band": float(f"{2 * sides.noise.stated[row, column] * measure.factor:.4g}"),
            "found": sides.noise.edge(row, column, measure.factor),
            "run": RUNS[int(flipped[row])] if flipped is not None else RUNS[0],
            "model": model,
            "row": row + 1,
        }
        for model, side in models
        for row in range(min(len(across.values), len(side.value)))
        if np.isfinite(side.value[row, column]) and np.isfinite(sides.noise.stated[row, column])
    ]


def _spec_of(across: Across, measure: Measure, largest: float, *, wider: bool) -> Json:
    x = BETA_RANGE if across.name == BETA else padded(float(across.values.min()), float(across.values.max()))
    texts = {CHANGE: say("measured − simulated, {label}", label=measure.label)}
    return filled(_spec(across.name, across.title, wider=wider), x, padded(-largest, largest), measure.label, texts)


@cache
def _spec(name: str, title: str, *, wider: bool) -> Json:
    """The specification, with blanks for the unit and the ranges."""
    x = alt.X("x:Q", title=title, axis=alt.Axis(**ticks(name)), scale=x_scale(nice=False, zero=False))
    scale = y_scale()
    y = y_axis(scale)
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    band = base.transform_calculate(low="-datum.band").mark_area(color="var(--muted)", opacity=0.1)
    return specification(
        [
            band.encode(y=alt.Y("low:Q", scale=scale), y2="band:Q", detail="run:N"),
            *(edges(base, scale, "var(--muted)") if wider else ()),
            zero_line(),
            _marks(base, y, MODELS[0]),
            _marks(base, y, MODELS[1]),
        ],
        HEIGHT,
    )


def _marks(base: "alt.Chart", y: "alt.Y", model: str) -> "alt.Chart":
    """Marks of one model: before empty, after full; direct round, flipped pointed."""
    first = model == MODELS[0]
    colour = "var(--second)" if first else "var(--accent)"
    empty, full = {"filled": False, "strokeWidth": 1.4}, {"filled": True, "stroke": "var(--card)", "strokeWidth": 0.5}
    style = empty if first else full
    chart: alt.Chart = (
        base.transform_filter(alt.datum.model == model)
        .mark_point(color=colour, opacity=1, size=38, **style)
        .encode(
            y=y,
            shape=alt.Shape("run:N", legend=None, scale=shapes()),
            tooltip=hints({"row:Q": "row", "run:N": "run", "model:N": "model", "y:Q": CHANGE}),
        )
    )
    return chart


def course_charts(course: Course, residuals: Residuals, name: str) -> tuple[ChartSet, ...]:
    """One set a unit: angles share one, the size has its own; none where the whole vector changed once."""
    across = across_of(course, residuals)
    angles = [k for k, component in enumerate(course.components) if component != SIZE]
    sizes = [k for k, component in enumerate(course.components) if component == SIZE]
    kinds = [(f"{name}-{label}", columns) for label, columns in (("angle", angles), ("size", sizes)) if columns]
    return tuple(_course_chart_set(course, residuals, across, label, columns) for label, columns in kinds)


def across_of(course: Course, residuals: Residuals) -> Across:
    """Along β where the course is smooth along it, else in the order measured."""
    angle = by_angle(residuals) if course.order.startswith("β") else None
    return in_order(residuals) if angle is None else angle


def measure_of(course: Course, component: str) -> Measure:
    """The measure of a component: an angle, or relative; components of one unit share it."""
    is_size = component == SIZE
    values = [
        abs(row[k]) for row in course.values for k, other in enumerate(course.components) if (other == SIZE) == is_size
    ]
    return deviation_measure(ACCELEROMETER, "scale" if is_size else "axis", max(values, default=0.0))


def _course_chart_set(course: Course, residuals: Residuals, across: Across, name: str, columns: list[int]) -> ChartSet:
    measure = measure_of(course, course.components[columns[0]])
    value = np.array(course.values)[:, columns] * measure.factor
    largest = float(np.max(np.abs(value), initial=0.0, where=np.isfinite(value)))
    is_joined = not course.order.startswith("no order")
    return ChartSet(
        name=name,
        heading=across.heading,
        spec=_filled(across, measure, largest, is_joined=is_joined),
        panels=tuple(
            _course_panel(course.components[k], value[:, place], residuals, across, measure)
            for place, k in enumerate(columns)
        ),
    )


def _course_panel(component: str, value: np.ndarray, residuals: Residuals, across: Across, measure: Measure) -> Panel:
    known = value[np.isfinite(value)]
    reach = float(np.abs(known).max(initial=0.0))
    return Panel(
        title=component,
        description=say(
            "{component}, up to {reach}{thin_space}{label}",
            component=component_in_words(component),
            reach=number(reach, decimals(reach)),
            thin_space=THIN,
            label=measure.label,
        ),
        datasets={DATA_FORM: _course_points(value, residuals, across)},
    )


def _course_points(value: np.ndarray, residuals: Residuals, across: Across) -> list[Json]:
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


def _filled(across: Across, measure: Measure, largest: float, *, is_joined: bool) -> Json:
    x = BETA_RANGE if across.name == BETA else (0, len(across.values) + 1)
    texts = {CHANGE: say("off by, {label}", label=measure.label)}
    spec = _course_spec(across.name, across.title, is_joined=is_joined)
    return filled(spec, x, padded(-largest, largest), measure.label, texts)


@cache
def _course_spec(name: str, title: str, *, is_joined: bool) -> Json:
    """The specification, with blanks for the unit and the ranges; ``is_joined``: neighbours are joined by a line."""
    x = alt.X("x:Q", title=title, axis=alt.Axis(**ticks(name)), scale=x_scale(nice=False))
    colour = alt.Color("run:N", legend=None, scale=alt.Scale(domain=RUNS, range=["var(--accent)", "var(--second)"]))
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x, y=y_axis(y_scale()), color=colour)
    lines = [base.mark_line(strokeWidth=1, opacity=0.6)] if is_joined else []
    marks = base.mark_point(filled=True, opacity=1, size=36, stroke="var(--card)", strokeWidth=0.5).encode(
        shape=alt.Shape("run:N", legend=None, scale=shapes()),
        tooltip=hints({"row:Q": "row", "run:N": "run", "y:Q": CHANGE}),
    )
    return specification([zero_line(), *lines, marks], HEIGHT)


def shared_chart(shared: Shared, kind: str, residuals: Residuals, name: str) -> ChartSet:
    """One panel: the course as the sensor that shows it most has it, of a ``kind``, and the others scaled onto it."""
    time = residuals.time
    across = in_order(residuals) if time is None else Across("time", "By time", "h", np.asarray(time) / 3600)
    course, measured, band = (np.array(x) for x in (shared.course, shared.measured, shared.band))
    reach = float(np.max(np.abs(np.concatenate([course, measured])) + COVERAGE * np.concatenate([band, band])))
    measure = deviation_measure(kind, "bias", reach)
    swing = float(np.ptp(course)) * measure.factor
    points = [
        {
            "x": float(f"{across.values[row]:.6g}"),
            "y": float(f"{measured[row] * measure.factor:.5g}"),
            "course": float(f"{course[row] * measure.factor:.5g}"),
            "low": float(f"{(measured[row] - COVERAGE * band[row]) * measure.factor:.5g}"),
            "high": float(f"{(measured[row] + COVERAGE * band[row]) * measure.factor:.5g}"),
            "row": row + 1,
        }
        for row in range(min(len(course), len(across.values)))
    ]
    return ChartSet(
        name=name,
        heading=across.heading,
        spec=_shared_spec(across, measure.label, reach * measure.factor),
        panels=(
            Panel(
                title=shared.drawn_for,
                description=say(
                    "moves by {swing} in the session",
                    swing=f"{number(swing, decimals(swing / 10))}{THIN}{measure.label}",
                ),
                datasets={DATA_FORM: points},
            ),
        ),
    )


def _shared_spec(across: Across, unit: str, reach: float) -> Json:
    domain = padded(float(np.min(across.values)), float(np.max(across.values)))
    scale = alt.Scale(domain=domain, nice=False, zero=False)
    x = alt.X("x:Q", title=across.title, axis=alt.Axis(**ticks(across.name)), scale=scale)
    y_scale = alt.Scale(domain=padded(-reach, reach))
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    band = base.mark_area(color="var(--muted)", opacity=0.2).encode(y=alt.Y("low:Q", scale=y_scale), y2="high:Q")
    line = base.mark_line(color="var(--accent)").encode(y=alt.Y("course:Q", scale=y_scale))
    marks = base.mark_point(color="var(--second)", filled=True, opacity=1, size=30).encode(
        y=alt.Y("y:Q", title=unit, axis=alt.Axis(tickCount=5), scale=y_scale),
        tooltip=hints({"row:Q": "row", "y:Q": say("all sensors together, {unit}", unit=unit)}),
    )
    return specification([band, line, marks], HEIGHT)
