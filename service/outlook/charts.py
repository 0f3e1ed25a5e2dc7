"""Histories of parameters with band, tolerance, verdicts and forecast."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import cache
from typing import Any

from estimator.json_object import Json
from service.kit.libraries import alt
from service.kit.measures import Measure, day_of, deviation_measure, in_measure, limit, measured, signed
from service.outlook.records import ParameterTrend
from service.outlook.rules.histories import MeasuredChange, changes_of
from service.outlook.rules.thinned import kept
from service.sessions.charts import (
    DATA_FORM,
    ChartSet,
    Panel,
    filled,
    hints,
    padded,
    specification,
    x_scale,
    y_axis,
    y_scale,
)
from service.sessions.records import ALL_PARAMETERS, HistoryPoint
from service.sessions.words.conditions import CONDITIONS, FIT, NOT_JUDGED, REFERENCE, Condition, condition_of
from service.units.records import Note, Service


@dataclass(frozen=True)
class TrackPoint:
    """One session's value: its change from the reference that held at the time, in people's units."""

    at: datetime
    session: str
    shown: float | None
    lower: float | None
    upper: float | None
    limit_lower: float | None
    limit_upper: float | None
    epoch: int
    """Counts the service events before the session: a line never runs across one."""
    text: str
    condition: Condition
    is_drawn: bool = True
    """Whether a chart shows it; others that are close may stand for it."""

    @property
    def limits(self) -> tuple[float, float] | None:
        """Both tolerance lines; None where nothing is judged."""
        if self.limit_lower is None or self.limit_upper is None:
            return None
        return self.limit_lower, self.limit_upper

    @property
    def day(self) -> str:
        """The date as people write it."""
        return day_of(self.at)


@dataclass(frozen=True)
class ParameterCourse:
    """One parameter of one sensor through time, oldest first; never empty."""

    name: str
    """Parameter and kind: tracks of one name share a unit and a chart."""
    sensor: str
    parameter: str
    unit: Measure
    points: tuple[TrackPoint, ...]

    @property
    def limits(self) -> tuple[TrackPoint, ...]:
        """The first point of every stretch with one tolerance."""
        firsts: list[TrackPoint] = []
        for point in self.points:
            if point.limits is not None and (not firsts or firsts[-1].limits != point.limits):
                firsts.append(point)
        return tuple(firsts)


def tracks_of(history: Iterable[HistoryPoint], services: Sequence[Service]) -> tuple[tuple[ParameterCourse, ...], ...]:
    """The tracks of a unit as charts show them, grouped by parameter and kind of sensor, sensors in the order they
    come."""
    groups: dict[tuple[int, str], dict[str, list[HistoryPoint]]] = {}
    for point in sorted(history, key=lambda p: p.at):
        group = groups.setdefault((ALL_PARAMETERS.index(point.parameter), point.kind), {})
        group.setdefault(point.sensor, []).append(point)
    return tuple(_group(groups[key], services) for key in sorted(groups))


def _group(by_sensor: dict[str, list[HistoryPoint]], services: Sequence[Service]) -> tuple[ParameterCourse, ...]:
    changes = {name: changes_of(by_sensor[name], services) for name in sorted(by_sensor, key=natural)}
    first = next(iter(changes.values()))[0].point
    largest = max(change.largest for course in changes.values() for change in course)
    unit = deviation_measure(first.kind, first.parameter, largest)
    name = f"{first.parameter}-{first.kind}"
    return tuple(
        ParameterCourse(name, sensor, first.parameter, unit, tuple(_track_point(*one, unit) for one in kept(course)))
        for sensor, course in changes.items()
    )


def natural(name: str) -> tuple[str, int, str]:
    """Orders names of sensors: A2 comes before A10."""
    digits = "".join(c for c in name if c.isdigit())
    return name.rstrip("0123456789"), int(digits or 0), name


def _track_point(change: MeasuredChange, is_drawn: bool, unit: Measure) -> TrackPoint:
    point, allowed = change.point, in_measure(change.tolerance, unit)
    floor = None if allowed is None else -allowed
    return TrackPoint(
        at=point.at,
        session=point.session,
        shown=in_measure(change.value, unit),
        lower=in_measure(change.lower, unit),
        upper=in_measure(change.upper, unit),
        limit_lower=0.0 if floor is not None and change.is_angle else floor,
        limit_upper=allowed,
        epoch=change.epoch,
        text=_text(change, unit),
        condition=judged_as(point),
        is_drawn=is_drawn,
    )


def judged_as(point: HistoryPoint) -> Condition:
    """The condition with which a point is marked."""
    return NOT_JUDGED if point.tolerance is None else condition_of(point.verdict, is_reference=point.is_reference)


def _text(change: MeasuredChange, unit: Measure) -> str:
    if change.value is None:
        return "not observable"
    write = measured if change.is_angle else signed
    return write(change.value, change.expanded, unit)


def tolerance_text(track: ParameterCourse) -> str:
    """``±40 µg`` as it holds now."""
    last = next((p.limit_upper for p in reversed(track.points) if p.limit_upper is not None), None)
    if last is None:
        return "not set"
    return limit(last / track.unit.factor, track.unit, track.parameter == "axis")


Trends = Mapping[tuple[str, str, str], ParameterTrend]
"""Trends by sensor, kind and parameter."""
NAMES = ("fan", "trend")
"""Names of the data sets."""
YEAR_SECONDS = 365.25 * 86400
"""Julian years, as rates a year are given in."""
ROOM = 1.5
"""The fan may widen a chart to this many tolerances, not further."""


def trend_of(track: ParameterCourse, trends: Trends) -> ParameterTrend | None:
    """The trend of a track."""
    return trends.get((track.sensor, track.name.rpartition("-")[2], track.parameter))


def forecast_data(
    track: ParameterCourse,
    trends: Trends,
    iso: Callable[[datetime], str],
    short: Callable[[float | None], float | None],
) -> dict[str, list[Json]]:
    """The data sets of one panel; empty without a trend."""
    trend = trend_of(track, trends)
    if trend is None or not trend.fan or trend.since is None:
        return {name: [] for name in NAMES}
    factor, last = track.unit.factor, trend.fan[0].at
    start = trend.level - trend.rate_per_year * (last - trend.since).total_seconds() / YEAR_SECONDS
    return {
        "fan": [
            {"t": iso(p.at), "lo9": short(p.low_90 * factor), "lo5": short(p.low_50 * factor),
             "y": short(p.middle * factor), "hi5": short(p.high_50 * factor), "hi9": short(p.high_90 * factor)}
            for p in trend.fan
        ],
        "trend": [{"t": iso(at), "y": short(y * factor)} for at, y in ((trend.since, start), (last, trend.level))],
    }  # fmt: skip


def forecast_layers(x: "alt.X") -> "list[alt.Chart]":
    """Bounds of 90 % and 50 %, the middle, and the trend behind it."""
    fan, trend = (alt.Chart(alt.NamedData(name=name)).encode(x=x) for name in NAMES)
    colour = "var(--second)"
    return [
        fan.mark_area(color=colour, opacity=0.12, clip=True).encode(y=alt.Y("lo9:Q"), y2="hi9:Q"),
        fan.mark_area(color=colour, opacity=0.2, clip=True).encode(y=alt.Y("lo5:Q"), y2="hi5:Q"),
        fan.mark_line(color=colour, strokeWidth=1.5, strokeDash=[4, 3], clip=True).encode(y=alt.Y("y:Q")),
        trend.mark_line(color=colour, strokeWidth=1.2, clip=True).encode(y=alt.Y("y:Q")),
    ]


def forecast_dates(tracks: Sequence[ParameterCourse], trends: Trends) -> list[datetime]:
    """The dates that a chart must have room for."""
    found = (trend_of(track, trends) for track in tracks)
    return [point.at for trend in found if trend is not None for point in trend.fan]


def forecast_edges(tracks: Sequence[ParameterCourse], trends: Trends) -> list[float]:
    """The values that a chart must have room for: the inner bounds, up to one and a half tolerances."""
    edges = []
    for track in tracks:
        trend = trend_of(track, trends)
        if trend is not None:
            most = ROOM * trend.tolerance
            inner = [edge for point in trend.fan for edge in (point.low_50, point.high_50)]
            edges += [max(-most, min(most, edge)) * track.unit.factor for edge in inner]
    return [max(edge, 0.0) if tracks[0].parameter == "axis" else edge for edge in edges]


HEIGHT = 150
"""Pixels: more than of residuals, for the fan of the forecast."""


@cache
def history_spec() -> Json:
    """The specification, with blanks for the unit and the ranges."""
    points, limits, services, notes = (alt.NamedData(name=n) for n in (DATA_FORM, "limits", "services", "notes"))
    x = alt.X("t:T", title=None, axis=alt.Axis(tickCount=4), scale=x_scale(type="utc"))
    y = y_axis(y_scale(zero=False))
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


def _breaks(services: "alt.NamedData") -> "alt.Chart":
    chart: alt.Chart = (
        alt.Chart(services)
        .mark_rule(color="var(--ink)", strokeWidth=2, strokeDash=[2, 2])
        .encode(
            x=alt.X("t:T"),
            tooltip=hints({"what:N": "service", "note:N": "note"}),
        )
    )
    return chart


def _remarks(notes: "alt.NamedData") -> "alt.Chart":
    """Marks of notes at the upper edge; their text is shown on pointing at one, and in the list below the charts."""
    chart: alt.Chart = (
        alt.Chart(notes)
        .mark_point(shape="triangle-down", filled=True, size=70, opacity=1, color="var(--second)")
        .encode(
            x=alt.X("t:T"),
            y=alt.value(6),
            tooltip=hints({"date:N": "note", "note:N": "text"}),
        )
    )
    return chart


def _marks(base: "alt.Chart", y: "alt.Y") -> "alt.Chart":
    shown = (*CONDITIONS, REFERENCE, NOT_JUDGED)
    names = [c.word for c in shown]

    def by_verdict(values: list[Any]) -> Json:
        return {"legend": None, "scale": alt.Scale(domain=names, range=values)}

    chart: alt.Chart = base.mark_point(filled=True, opacity=1, stroke="var(--card)", strokeWidth=0.8).encode(
        y=y,
        color=alt.Color("verdict:N", **by_verdict([f"var(--{c.key})" for c in shown])),
        shape=alt.Shape("verdict:N", **by_verdict([c.shape for c in shown])),
        size=alt.Size("verdict:O", **by_verdict([45 if c is FIT else 95 for c in shown])),
        tooltip=hints({"date:N": "date", "value:N": "value", "verdict:N": "verdict"}),
    )
    return chart


AIR = 0.04
"""Share of the time that is left empty on either side, so that no mark is cut."""


def history_charts(
    tracks: Sequence[ParameterCourse],
    services: Sequence[Service],
    notes: Sequence[Note] = (),
    trends: Sequence[ParameterTrend] = (),
) -> ChartSet:
    """The panels of one parameter; every track has the same parameter and unit."""
    known = {(trend.sensor, trend.kind, trend.parameter): trend for trend in trends}
    span = _span(tracks, known, [*(s.at for s in services), *(n.at for n in notes)])
    return ChartSet(
        name=tracks[0].name,
        heading=tracks[0].parameter,
        spec=filled(history_spec(), span, _range(tracks, known), tracks[0].unit.label),
        panels=tuple(_panel(track, services, notes, span, known) for track in tracks),
    )


def _panel(
    track: ParameterCourse, services: Sequence[Service], notes: Sequence[Note], span: list[str], trends: Trends
) -> Panel:
    return Panel(
        title=track.sensor,
        description=track.points[-1].text,
        condition=track.points[-1].condition if track.points[-1].limits else None,
        datasets={
            DATA_FORM: [_point(p) for p in track.points if p.shown is not None and p.is_drawn],
            "limits": _limits(track, span),
            **forecast_data(track, trends, _iso, _short),
            "services": [{"t": _iso(s.at), "what": s.kind, "note": s.note} for s in services],
            "notes": [{"t": _iso(n.at), "date": day_of(n.at), "note": n.text} for n in notes],
        },
    )


def _point(point: TrackPoint) -> Json:
    return {
        "t": _iso(point.at),
        "y": _short(point.shown),
        "lo": _short(point.lower),
        "hi": _short(point.upper),
        "verdict": point.condition.word,
        "epoch": point.epoch,
        "value": point.text,
        "date": point.day,
    }


def _limits(track: ParameterCourse, span: list[str]) -> list[Json]:
    starts = [_iso(point.at) for point in track.limits]
    return [
        {"from": start, "to": end, "ref": 0, "hi": _short(point.limit_upper), "lo": _short(point.limit_lower)}
        for point, start, end in zip(track.limits, [span[0], *starts[1:]], [*starts[1:], span[1]], strict=False)
    ]


def _iso(at: datetime) -> str:
    return f"{at.astimezone(UTC).replace(tzinfo=None).isoformat(timespec='microseconds')}Z"


def _short(value: float | None) -> float | None:
    """Six digits are more than a screen can show."""
    return None if value is None else float(f"{value:.6g}")


def _span(tracks: Sequence[ParameterCourse], trends: Trends, events: Sequence[datetime]) -> list[str]:
    """One stretch of time for all sensors, so that simultaneous events stand in line; it includes events since their
    first session, a note of today among them.
    """
    dates = [p.at for track in tracks for p in track.points] + forecast_dates(tracks, trends)
    dates += [at for at in events if at > min(dates)]
    air = (max(dates) - min(dates)) * AIR or timedelta(days=1)
    return [_iso(min(dates) - air), _iso(max(dates) + air)]


def _range(tracks: Sequence[ParameterCourse], trends: Trends) -> list[float]:
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
