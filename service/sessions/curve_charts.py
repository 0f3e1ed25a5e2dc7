"""Curves over temperature with their bands: a panel a sensor."""

from collections.abc import Iterator
from functools import cache

import numpy as np

from estimator.curves import Curve, ThermalCurves
from estimator.json_object import Json
from estimator.message import say
from estimator.results import Calibration
from estimator.session import Array
from service.kit.libraries import alt
from service.kit.measures import Measure, deviation_measure
from service.sessions.charts import (
    BAND,
    DATA_FORM,
    HEIGHT,
    UNIT,
    ChartSet,
    Panel,
    filled,
    hints,
    padded,
    specification,
    x_scale,
    y_axis,
    y_scale,
    zero_line,
)
from service.sessions.words.curves import change

POINTS = 56
"""Temperatures that a curve is drawn at."""


def curve_charts(calibration: Calibration) -> tuple[ChartSet, ...]:
    """Changes from the reference temperature, one set a kind of sensor and parameter; none without curves."""
    curves = calibration.thermal
    return () if curves is None else tuple(_sets(calibration, curves))


def _sets(calibration: Calibration, curves: ThermalCurves) -> Iterator[ChartSet]:
    kinds = {sensor.name: sensor.kind for sensor in calibration.sensors}
    for kind in dict.fromkeys(kinds[sensor.name] for sensor in curves.sensors):
        of_kind = [sensor for sensor in curves.sensors if kinds[sensor.name] == kind]
        yield _set(curves, kind, "bias", {sensor.name: sensor.bias for sensor in of_kind})
        scales = {sensor.name: sensor.scale for sensor in of_kind if sensor.scale is not None}
        if scales:
            yield _set(curves, kind, "scale", scales)


def _set(curves: ThermalCurves, kind: str, parameter: str, by_sensor: dict[str, Curve]) -> ChartSet:
    T = np.linspace(curves.lowest, curves.highest, POINTS)
    found = {name: change(curves, curve, parameter, T) for name, curve in by_sensor.items()}
    low = min(float((moved - u).min()) for moved, u in found.values())
    high = max(float((moved + u).max()) for moved, u in found.values())
    measure = deviation_measure(kind, parameter, max(-low, high))
    x, y = padded(curves.lowest, curves.highest), padded(low * measure.factor, high * measure.factor)
    words = {
        "bias": say("Bias of the {kind}s over temperature", kind=kind),
        "scale": say("Scale factor of the {kind}s over temperature", kind=kind),
    }
    return ChartSet(
        name=f"curves-{kind}-{parameter}",
        heading=words[parameter],
        spec=filled(_spec(), x, y, measure.label, {BAND: say("U, {label}", label=measure.label)}),
        panels=tuple(_panel(name, T, *found[name], measure, by_sensor[name].order) for name in by_sensor),
    )


def _panel(name: str, T: Array, moved: Array, spread: Array, measure: Measure, order: int) -> Panel:
    data: list[Json] = [
        {
            "x": float(f"{t:.4g}"),
            "y": float(f"{y * measure.factor:.5g}"),
            "low": float(f"{(y - u) * measure.factor:.5g}"),
            "high": float(f"{(y + u) * measure.factor:.5g}"),
            "band": float(f"{u * measure.factor:.3g}"),
        }
        for t, y, u in zip(T, moved, spread, strict=True)
    ]
    return Panel(name, say("polynomial of order {order}", order=order), {DATA_FORM: data})


@cache
def _spec() -> Json:
    """The specification, with blanks for the unit and the ranges."""
    x = alt.X("x:Q", title="°C", axis=alt.Axis(tickCount=5), scale=x_scale(nice=False))
    scale = y_scale()
    base = alt.Chart(alt.NamedData(name=DATA_FORM)).encode(x=x)
    shade = base.mark_area(color="var(--accent)", opacity=0.25).encode(y=alt.Y("low:Q", scale=scale), y2="high:Q")
    line = base.mark_line(color="var(--accent)", strokeWidth=2).encode(
        y=y_axis(scale), tooltip=hints({"x:Q": "°C", "y:Q": UNIT, "band:Q": BAND})
    )
    return specification([shade, zero_line(), line], HEIGHT)
