"""The history of a parameter of a sensor as people read it: in their unit, as a change from the reference."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime

from service.pages.units import deviation_unit, limit, measured, signed
from service.pages.verdicts import NOT_JUDGED, Condition, condition_of
from service.records import PARAMETERS, HistoryPoint, Service
from service.units import DeviationUnit


@dataclass(frozen=True)
class TrackPoint:
    """One session's value, in people's units, measured from the origin of its track."""

    at: datetime
    session: str
    shown: float | None
    lower: float | None
    upper: float | None
    reference: float | None
    limit_lower: float | None
    limit_upper: float | None
    epoch: int
    """Counts the service events before the session: a line never runs across one."""
    text: str
    condition: Condition

    @property
    def limits(self) -> tuple[float, float, float] | None:
        """Reference and both tolerance lines; None without a reference."""
        if self.reference is None or self.limit_lower is None or self.limit_upper is None:
            return None
        return self.reference, self.limit_lower, self.limit_upper

    @property
    def day(self) -> str:
        """The date as people write it."""
        return day_of(self.at)


@dataclass(frozen=True)
class Track:
    """One parameter of one sensor through time, oldest first; never empty."""

    name: str
    """Parameter and kind: tracks of one name share a unit and a chart."""
    sensor: str
    parameter: str
    unit: DeviationUnit
    points: tuple[TrackPoint, ...]

    @property
    def limits(self) -> tuple[tuple[TrackPoint, datetime], ...]:
        """Stretches with one reference and tolerance: the first point of each, and until when it holds."""
        firsts: list[TrackPoint] = []
        for point in self.points:
            if point.limits is not None and (not firsts or firsts[-1].limits != point.limits):
                firsts.append(point)
        ends = [p.at for p in firsts[1:]] + [self.points[-1].at]
        return tuple(zip(firsts, ends, strict=False))


def day_of(at: datetime) -> str:
    """``7 Mar 2026``."""
    return f"{at.day} {at:%b %Y}"


def tracks_of(history: Iterable[HistoryPoint], services: Sequence[Service]) -> tuple[tuple[Track, ...], ...]:
    """The tracks of a unit, grouped by parameter and kind of sensor, sensors in the order they come."""
    groups: dict[tuple[int, str], dict[str, list[HistoryPoint]]] = {}
    for point in sorted(history, key=lambda p: p.at):
        group = groups.setdefault((PARAMETERS.index(point.parameter), point.kind), {})
        group.setdefault(point.sensor, []).append(point)
    return tuple(_group(groups[key], services) for key in sorted(groups))


def _group(by_sensor: dict[str, list[HistoryPoint]], services: Sequence[Service]) -> tuple[Track, ...]:
    first = next(iter(by_sensor.values()))[0]
    unit = deviation_unit(first.kind, first.parameter, max(_extent(points) for points in by_sensor.values()))
    return tuple(
        Track(f"{first.parameter}-{first.kind}", sensor, first.parameter, unit, _points(points, unit, services))
        for sensor, points in sorted(by_sensor.items(), key=lambda item: _natural(item[0]))
    )


def _natural(name: str) -> tuple[str, int, str]:
    """A2 comes before A10."""
    digits = "".join(c for c in name if c.isdigit())
    return name.rstrip("0123456789"), int(digits or 0), name


def _origin(points: Sequence[HistoryPoint]) -> tuple[float, float]:
    """What changes are measured from (the latest reference, else the first value), and the size of one."""
    known = [p.reference for p in reversed(points) if p.reference is not None]
    known += [p.value for p in points if p.value is not None]
    origin = known[0] if known else 0.0
    return origin, (abs(origin) or 1.0) if points[0].parameter == "scale" else 1.0


def _extent(points: Sequence[HistoryPoint]) -> float:
    origin, one = _origin(points)
    values = [abs(p.value - origin) / one for p in points if p.value is not None]
    return max([*values, (points[-1].tolerance or 0.0) / one])


def _points(points: Sequence[HistoryPoint], unit: DeviationUnit, services: Sequence[Service]) -> tuple[TrackPoint, ...]:
    origin, one = _origin(points)
    is_angle = points[0].parameter == "axis"

    def shown(value: float | None) -> float | None:
        return None if value is None else (value - origin) / one * unit.factor

    def edge(point: HistoryPoint, side: int) -> float | None:
        if point.reference is None or point.tolerance is None:
            return None
        allowed = point.reference + side * point.tolerance
        return shown(max(0.0, allowed) if is_angle else allowed)

    return tuple(
        TrackPoint(
            at=p.at,
            session=p.session,
            shown=shown(p.value),
            lower=shown(_floor(p)),
            upper=shown(p.upper),
            reference=shown(p.reference),
            limit_lower=edge(p, -1),
            limit_upper=edge(p, +1),
            epoch=sum(s.at <= p.at for s in services),
            text=_text(p, origin, one, unit),
            condition=NOT_JUDGED if p.tolerance is None else condition_of(p.verdict),
        )
        for p in points
    )


def _floor(point: HistoryPoint) -> float | None:
    """An angle between axes is never below zero."""
    if point.lower is None or point.parameter != "axis":
        return point.lower
    return max(0.0, point.lower)


def _text(point: HistoryPoint, origin: float, one: float, unit: DeviationUnit) -> str:
    if point.value is None:
        return "not observable"
    spread = None if point.upper is None else (point.upper - point.value) / one
    write = measured if point.parameter == "axis" else signed
    return write((point.value - origin) / one, spread, unit)


def tolerance_text(track: Track) -> str:
    """``±40 µg`` as it holds now."""
    last = next((p.limits for p in reversed(track.points) if p.limits is not None), None)
    if last is None:
        return "not set"
    reference, _, upper = last
    return limit((upper - reference) / track.unit.factor, track.unit, track.parameter == "axis")
