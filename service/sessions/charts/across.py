"""What residuals are drawn against, and what every chart of them shares."""

from dataclasses import dataclass
from typing import Any

import altair as alt
import numpy as np

from estimator.results import Residuals
from estimator.session import Array
from service.kit.measures import Measure, decimals, number

HEIGHT = 130
"""Pixels: three rows of panels fit on a screen."""
ROUNDING = 1e-12
"""m/s² or rad/s: a ten-millionth of a µg (°/h) is what doubles leave of a fit that meets every reading."""
RUNS = ("direct", "flipped")
"""Of a two-axis stand; a session without runs is drawn as the first."""
BETA, ORDER = "beta", "order"
"""Names of the ways that every session with a stand, and every session, can be looked at."""
BETA_RANGE, BETA_TICKS = [-12, 372], [0, 90, 180, 270, 360]
"""Degrees: a full turn with room for the marks at its ends."""
SHAPES = alt.Scale(domain=RUNS, range=["circle", "triangle-up"])
"""Runs differ by shape, not by colour alone."""


@dataclass(frozen=True)
class Across:
    """What residuals are drawn against."""

    name: str
    heading: str
    title: str
    """Of the axis, with its unit."""
    values: Array
    """One a row of the session, shape (rows,), in the unit of the title: °, h, °C, or the row's number."""


def by_angle(residuals: Residuals) -> Across | None:
    """By β, 0 to 360°; None where the session had no stand."""
    if residuals.beta is None:
        return None
    return Across(BETA, "By the angle β of the head", "β, °", np.degrees(residuals.beta) % 360)


def in_order(residuals: Residuals) -> Across:
    """By the row's number, from 1."""
    return Across(ORDER, "In the order measured", "row", np.arange(1.0, len(residuals.value) + 1))


def ticks(name: str) -> dict[str, Any]:
    """Of the axis that residuals are drawn against."""
    return {"values": BETA_TICKS} if name == BETA else {"tickCount": 5}


def zero_line() -> alt.Chart:
    """Where measured and simulated agree."""
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
