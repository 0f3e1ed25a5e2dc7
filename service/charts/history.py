"""History of a parameter, a panel a sensor: value with band, tolerance, reference, verdicts, service breaks."""

from collections.abc import Sequence
from datetime import datetime, timedelta
from functools import cache
from typing import Any

import altair as alt

from service.charts import DATA_FORM, HIGH, LEFT, LOW, RIGHT, UNIT, ChartSet, Panel, filled, padded, specification
from service.charts.forecast import (
    Trends,
    forecast_data,
    forecast_dates,
    forecast_edges,
    forecast_layers,
    trends_by_place,
)
from service.charts.tracks import Track, TrackPoint
from service.records.event import Note, Service
from service.records.outlook import ParameterTrend
from service.words.conditions import CONDITIONS, FIT, NOT_JUDGED, REFERENCE
from service.words.names import day_of

HEIGHT = 150


def history_charts(
    tracks: Sequence[Track],
    services: Sequence[Service],
    notes: Sequence[Note] = (),
    trends: Sequence[ParameterTrend] = (),
) -> ChartSet:
    """The panels of one parameter; every track has the same parameter and unit."""
    known = trends_by_place(trends)
    span = _span(tracks, known)
    return ChartSet(
        name=tracks[0].name,
        heading=tracks[0].parameter,
        spec=_filled(tracks, span, known),
        panels=tuple(_panel(track, services, notes, span, known) for track in tracks),
    )


def _panel(track: Track, services: Sequence[Service], notes: Sequence[Note], span: list[str], trends: Trends) -> Panel:
    return Panel(
        title=track.sensor,
        description=track.points[-1].text,
        condition=track.points[-1].condition if track.points[-1].limits else None,
        datasets={
            DATA_FORM: [_point(p) for p in track.points if p.shown is not None],
            "limits": _limits(track, span),
            **forecast_data(track, trends, _iso, _short),
            "services": [{"t": _iso(s.at), "what": s.kind, "note": s.note} for s in services],
            "notes": [{"t": _iso(n.at), "date": day_of(n.at), "note": n.text} for n in notes],
        },
    )


def _point(point: TrackPoint) -> dict[str, Any]:
    return {
        "t": _iso(point.at),
        "y": _short(point.shown),
        "lo": _short(point.lower),
        "hi": _short(point.upper),
        "verdict": point.condition.formal,
        "epoch": point.epoch,
        "value": point.text,
        "date": point.day,
    }


def _limits(track: Track, span: list[str]) -> list[dict[str, Any]]:
    """Tolerance and reference, each stretch until the next one begins, from edge to edge of the chart."""
    starts = [_iso(point.at) for point in track.limits]
    return [
        {"from": start, "to": end, "ref": 0, "hi": _short(point.limit_upper), "lo": _short(point.limit_lower)}
        for point, start, end in zip(track.limits, [span[0], *starts[1:]], [*starts[1:], span[1]], strict=False)
    ]


def _iso(at: datetime) -> str:
    return at.strftime("%Y-%m-%dT%H:%M:%S.%fZ")


def _short(value: float | None) -> float | None:
    """Six digits are more than a screen can show."""
    return None if value is None else float(f"{value:.6g}")


def _filled(tracks: Sequence[Track], span: list[str], trends: Trends) -> dict[str, Any]:
    low, high = _range(tracks, trends)
    values = {UNIT: tracks[0].unit.label, LEFT: span[0], RIGHT: span[1], LOW: low, HIGH: high}
    found: dict[str, Any] = filled(_spec(), values)
    return found


@cache
def _spec() -> dict[str, Any]:
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


def _span(tracks: Sequence[Track], trends: Trends) -> list[str]:
    """One stretch of time for all sensors, so that what happened together stands in line."""
    dates = [p.at for track in tracks for p in track.points] + forecast_dates(tracks, trends)
    air = (max(dates) - min(dates)) * 0.04 or timedelta(days=1)
    return [_iso(min(dates) - air), _iso(max(dates) + air)]


def _range(tracks: Sequence[Track], trends: Trends) -> list[float]:
    """One range for all sensors: which of them stands out is then seen at a glance."""
    edges = [
        edge
        for track in tracks
        for p in track.points
        for edge in (p.shown, p.lower, p.upper, p.limit_lower, p.limit_upper)
        if edge is not None
    ]
    edges += forecast_edges(tracks, trends)
    return padded(min(edges), max(edges)) if edges else [-1.0, 1.0]
