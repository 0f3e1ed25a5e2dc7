"""Measured minus simulated before and after the causes are named, a panel a sensor: by angle, time, temperature."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import altair as alt
import numpy as np

from estimator.results import Residuals, SensorCalibration
from service.charts import DATA_FORM, ChartSet, Panel, padded, specification
from service.charts.across import (
    BETA,
    BETA_RANGE,
    HEIGHT,
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
from service.charts.noise import Noise, edges
from service.measures import THIN, Measure, deviation_measure

MOST_PANELS = 9
"""Sensors that are drawn one way of looking, three rows of three; the page says how many are left out."""
MODELS = ("before", "after")
"""Names of the models in the data, without the named causes and with them."""


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
        heading=f"{across.heading}, {kind}s" if several else across.heading,
        spec=_spec(across, measure, largest * measure.factor, wider=noise.times is not None),
        panels=tuple(_panel(sides, i, across, measure) for i in columns),
    )


def _panel(sides: Sides, column: int, across: Across, measure: Measure) -> Panel:
    shown = [_rms(side, column, measure) for side in (sides.before, sides.after) if side is not None]
    return Panel(
        title=sides.sensors[column].name,
        description=f"rms {' → '.join(shown)}{THIN}{measure.label}",
        condition=None,
        datasets={DATA_FORM: _points(sides, column, across, measure)},
    )


def _rms(side: Residuals, column: int, measure: Measure) -> str:
    value = side.value[:, column][np.isfinite(side.value[:, column])]
    return scatter_in_words(float(np.sqrt(np.mean(value**2))) if len(value) else 0.0, measure)


def _points(sides: Sides, column: int, across: Across, measure: Measure) -> list[dict[str, Any]]:
    both = [(MODELS[0], sides.before), *([] if sides.after is None else [(MODELS[1], sides.after)])]
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
        for model, side in both
        for row in range(min(len(across.values), len(side.value)))
        if np.isfinite(side.value[row, column]) and np.isfinite(sides.noise.stated[row, column])
    ]


def _spec(across: Across, measure: Measure, largest: float, *, wider: bool) -> dict[str, Any]:
    domain = BETA_RANGE if across.name == BETA else padded(float(across.values.min()), float(across.values.max()))
    axis, scale = alt.Axis(**ticks(across.name)), alt.Scale(domain=domain, nice=False, zero=False)
    x = alt.X("x:Q", title=across.title, axis=axis, scale=scale)
    y_scale = alt.Scale(domain=padded(-largest, largest))
    y = alt.Y("y:Q", title=measure.label, axis=alt.Axis(tickCount=5), scale=y_scale)
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    band = base.transform_calculate(low="-datum.band").mark_area(color="var(--muted)", opacity=0.1)
    return specification(
        [
            band.encode(y=alt.Y("low:Q", scale=y_scale), y2="band:Q", detail="run:N"),
            *(edges(base, y_scale, "var(--muted)") if wider else ()),
            zero_line(),
            _marks(base, y, measure, MODELS[0]),
            _marks(base, y, measure, MODELS[1]),
        ],
        HEIGHT,
    )


def _marks(base: alt.Chart, y: alt.Y, measure: Measure, model: str) -> alt.Chart:
    """Before as empty marks, after as full ones; direct round, flipped pointed."""
    first = model == MODELS[0]
    colour = "var(--second)" if first else "var(--accent)"
    empty, full = {"filled": False, "strokeWidth": 1.4}, {"filled": True, "stroke": "var(--card)", "strokeWidth": 0.5}
    style = empty if first else full
    chart: alt.Chart = (
        base.transform_filter(alt.datum.model == model)
        .mark_point(color=colour, opacity=1, size=38, **style)
        .encode(
            y=y,
            shape=alt.Shape("run:N", legend=None, scale=SHAPES),
            tooltip=[
                alt.Tooltip("row:Q", title="row"),
                alt.Tooltip("run:N", title="run"),
                alt.Tooltip("model:N", title="model"),
                alt.Tooltip("y:Q", title=f"measured − simulated, {measure.label}"),
            ],
        )
    )
    return chart
