"""The specification of a history: bands, tolerance, forecast, breaks, notes and verdicts in one order of layers."""

from functools import cache
from typing import Any

import altair as alt

from service.charts import DATA_FORM, HIGH, LEFT, LOW, RIGHT, UNIT, specification
from service.charts.forecast import forecast_layers
from service.words.conditions import CONDITIONS, FIT, NOT_JUDGED, REFERENCE

HEIGHT = 150
"""Pixels: more than of residuals, for the fan of the forecast."""


@cache
def history_spec() -> dict[str, Any]:
    """With blanks for the unit and the ranges."""
    points, limits, services, notes = (alt.NamedData(name=n) for n in (DATA_FORM, "limits", "services", "notes"))
    x = alt.X("t:T", title=None, axis=alt.Axis(tickCount=4), scale=alt.Scale(type="utc", domain=[LEFT, RIGHT]))
    y = alt.Y("y:Q", title=UNIT, axis=alt.Axis(tickCount=5), scale=alt.Scale(domain=[LOW, HIGH], zero=False))
    base = alt.Chart(points).encode(x=x)
    bounds = alt.Chart(limits).encode(x=alt.X("from:T"), x2="to:T")
    return specification(
        [
            bounds.mark_rect(color="var(--pass)", opacity=0.06).encode(y=alt.Y("lo:Q"), y2="hi:Q"),
            bounds.mark_rule(color="var(--tolerance)", strokeDash=[5, 3]).encode(y="hi:Q"),
            bounds.mark_rule(color="var(--tolerance)", strokeDash=[5, 3]).encode(y="lo:Q"),
            bounds.mark_rule(color="var(--muted)", strokeWidth=1).encode(y="ref:Q"),
            *forecast_layers(x),
            _breaks(services),
            _remarks(notes),
            base.mark_area(color="var(--accent)", opacity=0.18).encode(y=y, y2="hi:Q", detail="epoch:N")
            .encode(y=alt.Y("lo:Q")),
            base.mark_rule(color="var(--accent)", opacity=0.55).encode(y="lo:Q", y2="hi:Q"),
            base.mark_line(color="var(--accent)", strokeWidth=1.5).encode(y=y, detail="epoch:N"),
            _marks(base, y),
        ],
        HEIGHT,
    )  # fmt: skip


def _breaks(services: alt.NamedData) -> alt.Chart:
    chart: alt.Chart = (
        alt.Chart(services)
        .mark_rule(color="var(--ink)", strokeWidth=2, strokeDash=[2, 2])
        .encode(
            x=alt.X("t:T"),
            tooltip=[alt.Tooltip("what:N", title="service"), alt.Tooltip("note:N", title="note")],
        )
    )
    return chart


def _remarks(notes: alt.NamedData) -> alt.Chart:
    """A mark at the upper edge; what it says is read by pointing at it, and in the list below the charts."""
    chart: alt.Chart = (
        alt.Chart(notes)
        .mark_point(shape="triangle-down", filled=True, size=70, opacity=1, color="var(--second)")
        .encode(
            x=alt.X("t:T"),
            y=alt.value(6),
            tooltip=[alt.Tooltip("date:N", title="note"), alt.Tooltip("note:N", title="text")],
        )
    )
    return chart


def _marks(base: alt.Chart, y: alt.Y) -> alt.Chart:
    shown = (*CONDITIONS, REFERENCE, NOT_JUDGED)
    names = [c.formal for c in shown]

    def by_verdict(values: list[Any]) -> dict[str, Any]:
        return {"legend": None, "scale": alt.Scale(domain=names, range=values)}

    chart: alt.Chart = base.mark_point(filled=True, opacity=1, stroke="var(--card)", strokeWidth=0.8).encode(
        y=y,
        color=alt.Color("verdict:N", **by_verdict([f"var(--{c.key})" for c in shown])),
        shape=alt.Shape("verdict:N", **by_verdict([c.shape for c in shown])),
        size=alt.Size("verdict:O", **by_verdict([45 if c is FIT else 95 for c in shown])),
        tooltip=[
            alt.Tooltip("date:N", title="date"),
            alt.Tooltip("value:N", title="value"),
            alt.Tooltip("verdict:N", title="verdict"),
        ],
    )
    return chart
