"""How the sensors changed over the first minutes, a panel a sensor, with what they may drift by."""

from functools import cache
from typing import Any

import altair as alt
import numpy as np

from estimator.readiness import Readiness
from service.charts import DATA_FORM, ChartSet, Panel, specification
from service.measures import THIN, deviation_measure, number

HEIGHT = 140
"""Pixels: six panels fit on a screen."""
MINUTE = 60.0
"""s."""


def readiness_charts(found: Readiness, kinds: dict[str, str]) -> ChartSet | None:
    """One panel a sensor, all of one scale; None where nothing was recorded. ``kinds`` by sensor."""
    if not len(found.time):
        return None
    allowed = {one.name: one.allowed for one in found.outlooks}
    panels = tuple(_panel(found, i, kinds[name], allowed.get(name)) for i, name in enumerate(found.names))
    return ChartSet("readiness", "Change since the record began", _spec(), panels)


def _panel(found: Readiness, column: int, kind: str, allowed: float | None) -> Panel:
    change = found.change[:, column]
    measure = deviation_measure(kind, "bias", float(np.max(np.abs([*change, allowed or 0.0]))))
    minutes = found.time / MINUTE
    points = [
        {"x": float(f"{x:.5g}"), "y": float(f"{y * measure.factor:.4g}")} for x, y in zip(minutes, change, strict=True)
    ]
    limits = [] if allowed is None else [{"y": float(f"{side * allowed * measure.factor:.4g}")} for side in (-1, 1)]
    low, high = (number(float(f"{edge * measure.factor:.2g}")) for edge in (change.min(), change.max()))
    words = f"from {low} to {high}{THIN}{measure.label}"
    return Panel(found.names[column], words, None, {DATA_FORM: points, "allowed": limits})


@cache
def _spec() -> dict[str, Any]:
    points, limits = (alt.NamedData(name=name) for name in (DATA_FORM, "allowed"))
    x = alt.X("x:Q", title="minutes", axis=alt.Axis(tickCount=6), scale=alt.Scale(zero=False, nice=False))
    y = alt.Y("y:Q", title=None, axis=alt.Axis(tickCount=5), scale=alt.Scale(zero=False))
    hints = [alt.Tooltip("x:Q", title="minutes"), alt.Tooltip("y:Q", title="change")]
    line = alt.Chart(limits).mark_rule(color="var(--tolerance)", strokeDash=[5, 3]).encode(y=y)
    dots = (
        alt.Chart(points)
        .mark_point(filled=True, opacity=1, size=14, color="var(--accent)")
        .encode(x=x, y=y, tooltip=hints)
    )
    return specification([line, dots], HEIGHT)
