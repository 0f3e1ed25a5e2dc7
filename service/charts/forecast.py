"""The trend of a parameter and where it goes: a line through the sessions of its epoch, and a fan a year ahead."""

from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from typing import Any

import altair as alt

from service.charts.tracks import Track
from service.records.outlook import ParameterTrend

Trends = Mapping[tuple[str, str, str], ParameterTrend]
"""By sensor, kind and parameter."""
NAMES = ("fan", "trend")
"""Of the data sets."""
YEAR_SECONDS = 365.25 * 86400
"""Julian years, as rates a year are given in."""
ROOM = 1.5
"""The fan may widen a chart to this many tolerances, not further."""


def trends_by_place(trends: Sequence[ParameterTrend]) -> Trends:
    """As the charts look them up."""
    return {(trend.sensor, trend.kind, trend.parameter): trend for trend in trends}


def trend_of(track: Track, trends: Trends) -> ParameterTrend | None:
    """The trend of a track."""
    return trends.get((track.sensor, track.name.rpartition("-")[2], track.parameter))


def forecast_data(
    track: Track, trends: Trends, iso: Callable[[datetime], str], short: Callable[[float | None], float | None]
) -> dict[str, list[dict[str, Any]]]:
    """The data sets of one panel; empty without a trend."""
    trend = trend_of(track, trends)
    if trend is None or not trend.fan or trend.since is None:
        return {name: [] for name in NAMES}
    one, last = track.unit.factor, trend.fan[0].at
    start = trend.level - trend.rate_per_year * (last - trend.since).total_seconds() / YEAR_SECONDS
    return {
        "fan": [
            {"t": iso(p.at), "lo9": short(p.low_90 * one), "lo5": short(p.low_50 * one), "y": short(p.middle * one),
             "hi5": short(p.high_50 * one), "hi9": short(p.high_90 * one)}
            for p in trend.fan
        ],
        "trend": [{"t": iso(at), "y": short(y * one)} for at, y in ((trend.since, start), (last, trend.level))],
    }  # fmt: skip


def forecast_layers(x: alt.X) -> list[alt.Chart]:
    """Bounds of 90 % and 50 %, the middle, and the trend behind it."""
    fan, trend = (alt.Chart(alt.NamedData(name=name)).encode(x=x) for name in NAMES)
    colour = "var(--second)"
    return [
        fan.mark_area(color=colour, opacity=0.12, clip=True).encode(y=alt.Y("lo9:Q"), y2="hi9:Q"),
        fan.mark_area(color=colour, opacity=0.2, clip=True).encode(y=alt.Y("lo5:Q"), y2="hi5:Q"),
        fan.mark_line(color=colour, strokeWidth=1.5, strokeDash=[4, 3], clip=True).encode(y=alt.Y("y:Q")),
        trend.mark_line(color=colour, strokeWidth=1.2, clip=True).encode(y=alt.Y("y:Q")),
    ]


def forecast_dates(tracks: Sequence[Track], trends: Trends) -> list[datetime]:
    """The dates that a chart must have room for."""
    found = (trend_of(track, trends) for track in tracks)
    return [point.at for trend in found if trend is not None for point in trend.fan]


def forecast_edges(tracks: Sequence[Track], trends: Trends) -> list[float]:
    """The values that a chart must have room for: the inner bounds, up to one and a half tolerances."""
    edges = []
    for track in tracks:
        trend = trend_of(track, trends)
        if trend is not None:
            most = ROOM * trend.tolerance
            inner = [edge for point in trend.fan for edge in (point.low_50, point.high_50)]
            edges += [max(-most, min(most, edge)) * track.unit.factor for edge in inner]
    return [max(edge, 0.0) if tracks[0].parameter == "axis" else edge for edge in edges]
