"""Charts by Altair: one specification a kind of chart, drawn once for every panel with that panel's data.

A page carries the specification and the data as JSON; the browser joins and draws them. Colours are the page's
own style variables, so that charts follow light, dark and print.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import altair as alt

from service.sessions.words.conditions import Condition

DATA_FORM = "points"
"""Name of the main data set of every specification."""
UNIT, LEFT, RIGHT, LOW, HIGH = "{unit}", "{left}", "{right}", "{low}", "{high}"
"""Blanks of a specification: the unit of y, and the ranges of x and y."""

AIR = 0.06
"""Share of a range that is left empty above and below, so that no mark is cut."""
CONFIG: dict[str, Any] = {
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
    """One small chart: its heading, what it shows in words, and its data."""

    title: str
    description: str
    condition: Condition | None
    """The verdict to show beside the heading; None where nothing is judged."""
    datasets: dict[str, list[dict[str, Any]]]


@dataclass(frozen=True)
class ChartSet:
    """Panels that share one specification, and with it their scales."""

    name: str
    heading: str
    spec: dict[str, Any]
    panels: tuple[Panel, ...]


def specification(layers: list[alt.Chart], height: int) -> dict[str, Any]:
    """Layers as Vega-Lite that fills the width of its place."""
    chart = alt.layer(*layers).properties(width="container", height=height)
    return {**chart.to_dict(), "config": CONFIG, "autosize": {"type": "fit-x", "contains": "padding"}}


def filled(part: Any, values: Mapping[str, Any]) -> Any:
    """A specification with its blanks filled in: Altair takes long to make one, so each kind is made once."""
    if isinstance(part, dict):
        return {key: filled(value, values) for key, value in part.items()}
    if isinstance(part, list):
        return [filled(value, values) for value in part]
    return values.get(part, part) if isinstance(part, str) else part


def padded(low: float, high: float) -> list[float]:
    """A range with a little air above and below."""
    air = AIR * (high - low) or 1.0
    return [low - air, high + air]
