"""Residuals of a session, a panel a sensor: by β with both runs, and in the order measured, with ±2σ of the noise."""

from functools import cache
from typing import Any

import altair as alt
import numpy as np

from estimator.message import say
from estimator.results import Calibration, Residuals
from service.kit.measures import THIN, Measure, deviation_measure
from service.sessions.charts import (
    DATA_FORM,
    HIGH,
    LEFT,
    LOW,
    RIGHT,
    UNIT,
    ChartSet,
    Panel,
    filled,
    padded,
    specification,
)
from service.sessions.charts.across import (
    BETA,
    BETA_RANGE,
    HEIGHT,
    ORDER,
    RUNS,
    SHAPES,
    Across,
    by_angle,
    in_order,
    largest_edge,
    scatter_in_words,
    ticks,
    zero_line,
)
from service.sessions.charts.noise import Noise, edges, noise_of

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
    """The sensors of a kind that have residuals."""
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
        say(", {np} of {value} outside ±2σ", np=np.sum(np.abs(value) > 2 * sigma), value=len(value))
        if np.isfinite(sigma).any()
        else ""
    )
    rms = scatter_in_words(float(np.sqrt(np.nanmean(value**2))), unit)
    return Panel(
        title=calibration.sensors[column].name,
        description=say("rms {rms}{thin}{label}{outside}", rms=rms, thin=THIN, label=unit.label, outside=outside),
        condition=None,
        datasets={DATA_FORM: _rows(residuals, noise, column, across, unit)},
    )


def _rows(residuals: Residuals, noise: Noise, column: int, across: Across, unit: Measure) -> list[dict[str, Any]]:
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
            zip(across.values, residuals.value[:, column], noise.stated[:, column], flipped, strict=True),
            1,
        )
        if np.isfinite(y)
    ]


def _filled(across: Across, unit: Measure, largest: float, *, wider: bool) -> dict[str, Any]:
    left, right = BETA_RANGE if across.name == BETA else (0, len(across.values) + 1)
    low, high = padded(-largest, largest)
    ranges = {LEFT: left, RIGHT: right, LOW: low, HIGH: high}
    texts = {
        UNIT: unit.label,
        RESIDUAL: say("residual, {label}", label=unit.label),
        BAND: say("2σ stated, {label}", label=unit.label),
    }
    found: dict[str, Any] = filled(_spec(across.name, across.title, wider=wider), {**ranges, **texts})
    return found


@cache
def _spec(name: str, title: str, *, wider: bool) -> dict[str, Any]:
    """With blanks for the unit and the ranges; ``wider``: with the edges of the noise found."""
    x = alt.X("x:Q", title=title, axis=alt.Axis(**ticks(name)), scale=alt.Scale(domain=[LEFT, RIGHT], nice=False))
    y_scale = alt.Scale(domain=[LOW, HIGH])
    y = alt.Y("y:Q", title=UNIT, axis=alt.Axis(tickCount=5), scale=y_scale)
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    band = base.transform_calculate(low="-datum.band").mark_area(color="var(--accent)", opacity=SHADES[name])
    shades = band.encode(y=alt.Y("low:Q", scale=y_scale), y2="band:Q", detail="run:N")
    found = edges(base, y_scale, "var(--accent)") if wider else []
    return specification([shades, *found, zero_line(), _marks(base, y)], HEIGHT)


def _marks(base: alt.Chart, y: alt.Y) -> alt.Chart:
    chart: alt.Chart = base.mark_point(filled=True, opacity=1, size=36, stroke="var(--card)", strokeWidth=0.5).encode(
        y=y,
        color=alt.Color("run:N", legend=None, scale=alt.Scale(domain=RUNS, range=["var(--accent)", "var(--second)"])),
        shape=alt.Shape("run:N", legend=None, scale=SHAPES),
        tooltip=[
            alt.Tooltip("row:Q", title="row"),
            alt.Tooltip("run:N", title="run"),
            alt.Tooltip("y:Q", title=RESIDUAL),
            alt.Tooltip("band:Q", title=BAND),
        ],
    )
    return chart
