"""Expected uncertainty over the plan."""

from functools import cache

import numpy as np

from estimator.json_object import Json
from estimator.message import say
from estimator.planning import Plan, Sweep
from estimator.results import PARAMETERS
from estimator.session import Array
from service.kit.libraries import alt
from service.kit.measures import MEASURES, Measure, heading
from service.sessions.charts import DATA_FORM, ChartSet, Panel, hints, specification

HEIGHT = 150
"""Pixels: two rows of panels fit on a screen."""
SERIES = ("total", "repeatability", "tolerance")
COLOURS = ["var(--accent)", "var(--second)", "var(--tolerance)"]
DASHES = [[1, 0], [4, 3], [5, 3]]
"""Colours and dashes of the lines of a panel; the dashes tell them apart in black and white too."""


def plan_charts(plan: Plan, kind: str) -> tuple[ChartSet, ChartSet]:
    """Charts over N at the plan's elevation, and over the elevation at the plan's N."""
    degrees = np.degrees(plan.over_elevation.at)
    by_number = _parameters(plan, kind, plan.over_positions, plan.over_positions.at.astype(float), plan.positions)
    by_angle = _parameters(plan, kind, plan.over_elevation, degrees, float(np.degrees(plan.elevation)))
    return (
        ChartSet("positions", "Over the number of positions", _spec("positions a run"), tuple(by_number)),
        ChartSet(
            "elevation", "Over the elevation of the head", _spec(say("elevation, °")), (*by_angle, *_rho(plan, degrees))
        ),
    )


def _parameters(plan: Plan, kind: str, sweep: Sweep, at: Array, chosen: float) -> list[Panel]:
    """One panel a parameter that is observed anywhere; ``at``, shape (points,), is the number of positions or in °."""
    wanted = plan.request.wanted.row() * plan.request.share
    panels = []
    for k, name in enumerate(PARAMETERS):
        measure, coverage = MEASURES[kind, name], plan.request.coverage
        pairs = [(series, getattr(sweep, series)[:, k] * coverage * measure.factor) for series in SERIES[:2]]
        points = [p for series, values in pairs for p in _points(series, at, values)]
        if points:
            if np.isfinite(wanted[k]):
                points += _points(SERIES[2], at, np.full(len(at), wanted[k] * measure.factor))
            panels.append(_panel(heading(name), measure, points, chosen))
    return panels


def _panel(title: str, measure: Measure, points: list[Json], chosen: float) -> Panel:
    words = (
        say("U of the worst sensor, {label}", label=measure.label)
        if measure.label
        else "largest over smallest eigenvalue"
    )
    return Panel(title=title, description=words, datasets={DATA_FORM: points, "chosen": [{"x": round(chosen, 2)}]})


def _points(series: str, at: Array, values: Array) -> list[Json]:
    """Finite values over where they hold, both of shape (points,), in the units of the panel's axes (number or °)."""
    return [
        {"x": round(float(x), 2), "y": float(f"{y:.4g}"), "series": series}
        for x, y in zip(at, values, strict=True)
        if np.isfinite(y)
    ]


def _rho(plan: Plan, degrees: Array) -> list[Panel]:
    """The conditioning, where it is finite, over elevations in °, shape (points,)."""
    points = _points("total", degrees, plan.over_elevation.conditioning)
    if not points:
        return []
    panel = _panel("Conditioning ρ", Measure("", 1.0), points, float(np.degrees(plan.elevation)))
    return [panel]


@cache
def _spec(across: str) -> Json:
    points, chosen = (alt.NamedData(name=n) for n in (DATA_FORM, "chosen"))
    x = alt.X("x:Q", title=across, axis=alt.Axis(tickCount=6), scale=alt.Scale(zero=False, nice=False))
    y = alt.Y("y:Q", title=None, axis=alt.Axis(tickCount=5), scale=alt.Scale(zero=True))
    colour = alt.Color("series:N", legend=None, scale=alt.Scale(domain=SERIES, range=COLOURS))
    dash = alt.StrokeDash("series:N", legend=None, scale=alt.Scale(domain=SERIES, range=DASHES))
    base = alt.Chart(points).encode(x=x, y=y, color=colour)
    shown = hints({"x:Q": across, "y:Q": "value", "series:N": "part"})
    return specification(
        [
            alt.Chart(chosen).mark_rule(color="var(--ink)", strokeDash=[2, 2]).encode(x="x:Q"),
            base.mark_line(strokeWidth=1.5).encode(strokeDash=dash),
            base.transform_filter("datum.series != 'tolerance'")
            .mark_point(filled=True, opacity=1, size=20)
            .encode(tooltip=shown),
        ],
        HEIGHT,
    )
