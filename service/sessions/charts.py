"""Charts by Altair: one specification a kind of chart, drawn once for every panel with that panel's data.

A page carries the specification and the data as JSON; the browser joins and draws them. Colours are the page's
own style variables, so that charts follow light, dark and print.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import isfinite, sqrt
from typing import Any

import numpy as np

from estimator.json_object import Json
from estimator.message import say
from estimator.results import Calibration, Residuals
from estimator.session import Array
from service.kit.libraries import alt
from service.kit.measures import THIN, Measure, decimals, deviation_measure, number
from service.sessions.words.conditions import Condition

DATA_FORM = "points"
"""Name of the main data set of every specification."""
UNIT, LEFT, RIGHT, LOW, HIGH = "{unit}", "{left}", "{right}", "{low}", "{high}"
"""Blanks of a specification: the unit of y, and the ranges of x and y."""
NO_TEXTS: Mapping[str, str] = {}

AIR = 0.06
"""Share of a range that is left empty above and below, so that no mark is cut."""
CONFIG: Json = {
    "background": "transparent",
    "font": "system-ui, sans-serif",
    "view": {"stroke": "var(--line)", "fill": "transparent"},
    "mark": {"aria": False},  # the table beside it says the same, and better, than hundreds of marks read aloud
    "axis": {
        "domain": False,
        "grid": True,
        "gridColor": "var(--grid)",
        "tickColor": "var(--line)",
        "tickSize": 4,
        "labelColor": "var(--muted)",
        "labelFontSize": 11,
        "labelPadding": 4,
        "titleColor": "var(--muted)",
        "titleFontSize": 11,
        "titleFontWeight": "normal",
    },
    "axisX": {"grid": False},
}
"""The look of every chart, in the style variables of the pages."""


@dataclass(frozen=True)
class Panel:
    """One small chart: its heading, its description in words, and its data."""

    title: str
    description: str
    datasets: dict[str, list[Json]]
    condition: Condition | None = None
    """The verdict to show beside the heading; None where nothing is judged."""


@dataclass(frozen=True)
class ChartSet:
    """Panels that share one specification, and with it their scales."""

    name: str
    heading: str
    spec: Json
    panels: tuple[Panel, ...]


ZOOM: Json = {
    "name": "zoom",
    "select": {
        "type": "interval",
        "zoom": "wheel![event.ctrlKey || event.metaKey]",
        "translate": "[pointerdown[event.pointerType === 'mouse'], window:pointerup] > window:pointermove!",
    },
    "bind": "scales",
}
"""Ctrl and the wheel zoom, the mouse drags, a double click resets; wheel and finger alone scroll the page."""


def specification(layers: "list[alt.Chart]", height: int) -> Json:
    """Layers as Vega-Lite that fills the width of its place; the last one, of marks, can be zoomed."""
    chart = alt.layer(*layers).properties(width="container", height=height).to_dict()
    chart["layer"][-1]["params"] = [ZOOM]
    return {**chart, "config": CONFIG, "autosize": {"type": "fit-x", "contains": "padding"}}


def hints(titles: Mapping[str, str]) -> "list[alt.Tooltip]":
    """The tooltips of a mark: fields with their titles."""
    return [alt.Tooltip(field, title=title) for field, title in titles.items()]


def x_scale(**options: Any) -> "alt.Scale":
    """A scale over the range that x is given."""
    return alt.Scale(domain=[LEFT, RIGHT], **options)


def y_scale(**options: Any) -> "alt.Scale":
    """A scale over the range that y is given."""
    return alt.Scale(domain=[LOW, HIGH], **options)


def y_axis(scale: "alt.Scale") -> "alt.Y":
    """The values, in their unit."""
    return alt.Y("y:Q", title=UNIT, axis=alt.Axis(tickCount=5), scale=scale)


def filled(spec: Json, x: Sequence[Any], y: Sequence[float], unit: str, texts: Mapping[str, str] = NO_TEXTS) -> Json:
    """A specification with its ranges, unit and texts: Altair takes long to make one, so each kind is made once."""
    ranges = {LEFT: x[0], RIGHT: x[1], LOW: y[0], HIGH: y[1], UNIT: unit}
    found: Json = _filled_in(spec, {**ranges, **texts})
    return found


def _filled_in(part: Any, values: Mapping[str, Any]) -> Any:
    if isinstance(part, dict):
        return {key: _filled_in(value, values) for key, value in part.items()}
    if isinstance(part, list):
        return [_filled_in(value, values) for value in part]
    return values.get(part, part) if isinstance(part, str) else part


def padded(low: float, high: float) -> list[float]:
    """A range with a little air above and below."""
    air = AIR * (high - low) or 1.0
    return [low - air, high + air]


HEIGHT = 130
"""Pixels: three rows of panels fit on a screen."""
ROUNDING = 1e-12
"""m/s² or rad/s: a ten-millionth of a µg (°/h) is what doubles leave of a fit that meets every reading."""
RUNS = ("direct", "flipped")
"""Runs of a two-axis stand; a session without runs is drawn as the first."""
BETA, ORDER = "beta", "order"
"""Names of the ways that every session with a stand, and every session, can be looked at."""
BETA_RANGE, BETA_TICKS = [-12, 372], [0, 90, 180, 270, 360]
"""Degrees: a full turn with room for the marks at its ends."""


def shapes() -> "alt.Scale":
    """The two runs differ without colour too."""
    return alt.Scale(domain=RUNS, range=["circle", "triangle-up"])


"""Runs differ by shape, not by colour alone."""


@dataclass(frozen=True)
class Across:
    """Variable against which residuals are drawn."""

    name: str
    heading: str
    title: str
    """Title of the axis, with its unit."""
    values: Array
    """One a row of the session, shape (rows,), in the unit of the title: °, h, °C, or the row's number."""


def by_angle(residuals: Residuals) -> Across | None:
    """The angle β, 0 to 360°, as the variable; None where the session had no stand."""
    if residuals.beta is None:
        return None
    return Across(BETA, "By the angle β of the head", "β, °", np.degrees(residuals.beta) % 360)


def in_order(residuals: Residuals) -> Across:
    """The row's number, from 1, as the variable."""
    return Across(ORDER, "In the order measured", "row", np.arange(1.0, len(residuals.value) + 1))


def ticks(name: str) -> dict[str, Any]:
    """Ticks of the axis against which residuals are drawn."""
    return {"values": BETA_TICKS} if name == BETA else {"tickCount": 5}


def zero_line() -> "alt.Chart":
    """A line where measured and simulated agree."""
    chart: alt.Chart = (
        alt.Chart(alt.InlineData(values=[{"zero": 0}])).mark_rule(color="var(--muted)").encode(y="zero:Q")
    )
    return chart


def largest_edge(value: Array, *sigmas: Array) -> float:
    """The largest |residual| or 2σ of some sensors, all (rows, sensors), m/s² or rad/s; 0 without any but rounding."""
    edges = np.abs(np.stack([value, *(2 * sigma for sigma in sigmas)]))
    found = float(np.max(edges, initial=0.0, where=np.isfinite(edges)))
    return 0.0 if found < ROUNDING else found


def scatter_in_words(size: float, measure: Measure) -> str:
    """A root mean square, m/s² or rad/s, in a measure; 0 where it is rounding, as without degrees of freedom."""
    shown = size * measure.factor
    return "0" if size < ROUNDING else number(shown, decimals(shown))


WIDER = 1.01
"""Times by which the noise found must be larger to be drawn of its own: less cannot be seen."""
DASHES = [4, 3]
"""Pixels drawn and left out of the edge of the noise that was found."""


@dataclass(frozen=True, eq=False)
class Noise:
    """The noise of R rows of m sensors."""

    stated: Array
    """(R, m) one sigma at the input, m/s² or rad/s: as the file states it, estimated where it states none."""
    growth: Array
    """(m,) how many times as large the calibration reckons with, no less than 1."""

    @property
    def found(self) -> Array:
        """(R, m) one sigma that the calibration reckons with, m/s² or rad/s."""
        return self.stated * self.growth

    @property
    def times(self) -> float | None:
        """Largest ratio of the noise found to the stated one among the sensors; None where it is not drawn."""
        most = float(self.growth.max(initial=1.0))
        return most if most > WIDER else None

    def edge(self, row: int, column: int, factor: float) -> float | None:
        """2σ found of a reading, in a measure; None where it is not drawn of its own."""
        return float(f"{2 * self.found[row, column] * factor:.4g}") if self.growth[column] > WIDER else None


def noise_of(residuals: Residuals, calibration: Calibration) -> Noise:
    """Stated as of some residuals, found as of a calibration of the same session.

    The median over a sensor's rows, because readings that take no part are given a sigma beyond all bounds.
    """
    stated, of_calibration = _stated(residuals), _stated(calibration.residuals)
    factor = calibration.fit.covariance_factor
    if calibration.residuals.enlarged_by is None or not isfinite(factor):
        return Noise(stated, np.ones(stated.shape[1]))
    known = np.isfinite(stated) & np.isfinite(of_calibration) & (stated > 0)
    ratio = np.divide(of_calibration, stated, out=np.ones_like(stated), where=known)
    return Noise(stated, np.maximum(1.0, np.median(ratio, axis=0) * sqrt(max(factor, 1.0))))


def _stated(residuals: Residuals) -> Array:
    return np.asarray(residuals.sigma / (residuals.enlarged_by or 1.0))


def edges(base: "alt.Chart", scale: "alt.Scale", colour: str) -> "list[alt.Chart]":
    """Dashed lines at both edges of the noise found; ``base`` has x and, in its data, ``found``."""
    drawn = base.transform_filter("isValid(datum.found)").transform_calculate(opposite="-datum.found")
    line = drawn.mark_line(color=colour, strokeDash=DASHES, strokeWidth=1)
    return [line.encode(y=alt.Y(f"{name}:Q", scale=scale), detail="run:N") for name in ("found", "opposite")]


RESIDUAL, BAND = "{residual}", "{band}"
"""Blanks: the names of the tooltip's numbers, with their unit."""
SHADES = {BETA: 0.07, ORDER: 0.13}
"""Opacity of the bands, ±2σ of the stated noise: by the angle both runs lie on each other."""


def residual_charts(calibration: Calibration) -> tuple[ChartSet, ...]:
    """One set a kind of sensor and way of looking: by β where the session had a stand, and in order."""
    kinds = dict.fromkeys(s.kind for s in calibration.sensors)
    return tuple(
        _chart_set(calibration, kind, across, several=len(kinds) > 1)
        for across in _ways(calibration.residuals)
        for kind in kinds
        if _columns(calibration, kind)
    )


def _columns(calibration: Calibration, kind: str) -> list[int]:
    value = calibration.residuals.value
    return [i for i, s in enumerate(calibration.sensors) if s.kind == kind and np.isfinite(value[:, i]).any()]


def _ways(residuals: Residuals) -> tuple[Across, ...]:
    angle, order = by_angle(residuals), in_order(residuals)
    return (order,) if angle is None else (angle, order)


def _chart_set(calibration: Calibration, kind: str, across: Across, several: bool) -> ChartSet:
    columns = _columns(calibration, kind)
    residuals = calibration.residuals
    noise = noise_of(residuals, calibration)
    largest = largest_edge(residuals.value[:, columns], noise.stated[:, columns], noise.found[:, columns])
    unit = deviation_measure(kind, "bias", largest)
    return ChartSet(
        name=f"residuals-{kind}-{across.name}",
        heading=say("{heading}, {kind}", heading=across.heading, kind=f"{kind}s") if several else across.heading,
        spec=_filled(across, unit, largest * unit.factor, wider=noise.times is not None),
        panels=tuple(_panel(calibration, i, across, unit) for i in columns),
    )


def _panel(calibration: Calibration, column: int, across: Across, unit: Measure) -> Panel:
    residuals = calibration.residuals
    noise = noise_of(residuals, calibration)
    value, sigma = residuals.value[:, column], noise.stated[:, column]
    outside = (
        say(", {number} of {total} outside ±2σ", number=np.sum(np.abs(value) > 2 * sigma), total=len(value))
        if np.isfinite(sigma).any()
        else ""
    )
    rms = scatter_in_words(float(np.sqrt(np.nanmean(value**2))), unit)
    return Panel(
        title=calibration.sensors[column].name,
        description=say(
            "rms {rms}{thin_space}{label}{outside}", rms=rms, thin_space=THIN, label=unit.label, outside=outside
        ),
        datasets={DATA_FORM: _rows(residuals, noise, column, across, unit)},
    )


def _rows(residuals: Residuals, noise: Noise, column: int, across: Across, unit: Measure) -> list[Json]:
    flipped = np.zeros(len(residuals.value), bool) if residuals.flipped is None else residuals.flipped
    return [
        {
            "x": float(f"{x:.6g}"),
            "y": float(f"{y * unit.factor:.5g}"),
            "band": float(f"{2 * s * unit.factor:.5g}") if np.isfinite(s) else 0.0,
            "found": noise.edge(row - 1, column, unit.factor),
            "run": RUNS[int(turned)],
            "row": row,
        }
        for row, (x, y, s, turned) in enumerate(
            zip(across.values, residuals.value[:, column], noise.stated[:, column], flipped, strict=True), 1
        )
        if np.isfinite(y)
    ]


def _filled(across: Across, unit: Measure, largest: float, *, wider: bool) -> Json:
    x = BETA_RANGE if across.name == BETA else (0, len(across.values) + 1)
    label = unit.label
    texts = {RESIDUAL: say("residual, {label}", label=label), BAND: say("2σ stated, {label}", label=label)}
    return filled(_spec(across.name, across.title, wider=wider), x, padded(-largest, largest), label, texts)


@cache
def _spec(name: str, title: str, *, wider: bool) -> Json:
    """The specification, with blanks for the unit and the ranges; ``wider``: with the edges of the noise found."""
    x, scale = alt.X("x:Q", title=title, axis=alt.Axis(**ticks(name)), scale=x_scale(nice=False)), y_scale()
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    band = base.transform_calculate(low="-datum.band").mark_area(color="var(--accent)", opacity=SHADES[name])
    shades = band.encode(y=alt.Y("low:Q", scale=scale), y2="band:Q", detail="run:N")
    found = edges(base, scale, "var(--accent)") if wider else []
    return specification([shades, *found, zero_line(), _marks(base, y_axis(scale))], HEIGHT)


def _marks(base: "alt.Chart", y: "alt.Y") -> "alt.Chart":
    chart: alt.Chart = base.mark_point(filled=True, opacity=1, size=36, stroke="var(--card)", strokeWidth=0.5).encode(
        y=y,
        color=alt.Color("run:N", legend=None, scale=alt.Scale(domain=RUNS, range=["var(--accent)", "var(--second)"])),
        shape=alt.Shape("run:N", legend=None, scale=shapes()),
        tooltip=hints({"row:Q": "row", "run:N": "run", "y:Q": RESIDUAL, "band:Q": BAND}),
    )
    return chart
