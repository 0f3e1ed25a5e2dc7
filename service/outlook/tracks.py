"""The history of a parameter of a sensor as people read it: in their unit, as a change from the reference."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime

from service.kit.measures import Measure, deviation_measure, in_measure, limit, measured, signed
from service.kit.names import day_of
from service.outlook.changes_since import Change, changes_of
from service.sessions.records import ALL_PARAMETERS, HistoryPoint
from service.sessions.words.conditions import NOT_JUDGED, Condition, condition_of
from service.units.records import Service


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
class Track:
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


def tracks_of(history: Iterable[HistoryPoint], services: Sequence[Service]) -> tuple[tuple[Track, ...], ...]:
    """The tracks of a unit, grouped by parameter and kind of sensor, sensors in the order they come."""
    groups: dict[tuple[int, str], dict[str, list[HistoryPoint]]] = {}
    for point in sorted(history, key=lambda p: p.at):
        group = groups.setdefault((ALL_PARAMETERS.index(point.parameter), point.kind), {})
        group.setdefault(point.sensor, []).append(point)
    return tuple(_group(groups[key], services) for key in sorted(groups))


def _group(by_sensor: dict[str, list[HistoryPoint]], services: Sequence[Service]) -> tuple[Track, ...]:
    changes = {name: changes_of(by_sensor[name], services) for name in sorted(by_sensor, key=_natural)}
    first = next(iter(changes.values()))[0].point
    largest = max(change.largest for own in changes.values() for change in own)
    unit = deviation_measure(first.kind, first.parameter, largest)
    return tuple(
        Track(f"{first.parameter}-{first.kind}", name, first.parameter, unit, tuple(_point(c, unit) for c in own))
        for name, own in changes.items()
    )


def _natural(name: str) -> tuple[str, int, str]:
    """A2 comes before A10."""
    digits = "".join(c for c in name if c.isdigit())
    return name.rstrip("0123456789"), int(digits or 0), name


def _point(change: Change, unit: Measure) -> TrackPoint:
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
        condition=NOT_JUDGED
        if point.tolerance is None
        else condition_of(point.verdict, is_reference=point.is_reference),
    )


def _text(change: Change, unit: Measure) -> str:
    if change.value is None:
        return "not observable"
    write = measured if change.is_angle else signed
    return write(change.value, change.expanded, unit)


def tolerance_text(track: Track) -> str:
    """``±40 µg`` as it holds now."""
    last = next((p.limit_upper for p in reversed(track.points) if p.limit_upper is not None), None)
    if last is None:
        return "not set"
    return limit(last / track.unit.factor, track.unit, track.parameter == "axis")
