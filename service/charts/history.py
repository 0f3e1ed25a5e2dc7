"""History of a parameter, a panel a sensor: value with band, tolerance, reference, verdicts, service breaks."""

from collections.abc import Sequence
from datetime import datetime, timedelta
from typing import Any

from service.charts import DATA_FORM, HIGH, LEFT, LOW, RIGHT, UNIT, ChartSet, Panel, filled, padded
from service.charts.forecast import (
    Trends,
    forecast_data,
    forecast_dates,
    forecast_edges,
    trends_by_place,
)
from service.charts.history_spec import history_spec
from service.charts.tracks import Track, TrackPoint
from service.records.event import Note, Service
from service.records.outlook import ParameterTrend
from service.words.names import day_of

AIR = 0.04
"""Share of the time that is left empty on either side, so that no mark is cut."""


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
    found: dict[str, Any] = filled(history_spec(), values)
    return found


def _span(tracks: Sequence[Track], trends: Trends) -> list[str]:
    """One stretch of time for all sensors, so that what happened together stands in line."""
    dates = [p.at for track in tracks for p in track.points] + forecast_dates(tracks, trends)
    air = (max(dates) - min(dates)) * AIR or timedelta(days=1)
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
