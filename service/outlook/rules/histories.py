"""Step: judged changes since the last break → a history of each parameter, and its contribution to the unit's type."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from math import hypot

import numpy as np

from estimator.health.pooled import Evidence
from estimator.health.prognosis import Track, evidence
from estimator.health.temperature_law import FOLLOW
from estimator.health.warmth import shows_temperature
from estimator.session import comparable
from service.kit.measures import YEAR
from service.outlook.store import ChangeRow, ReferenceRow
from service.sessions.records import HistoryPoint
from service.units.records import Service


@dataclass(frozen=True)
class MeasuredChange:
    """One point of a history and what its change is measured from."""

    point: HistoryPoint
    epoch: int
    """Counts the service events before the session: a line never runs across one."""
    origin: float

    @property
    def value(self) -> float | None:
        """The change as it was judged; None where the session does not observe the parameter."""
        if self.point.deviation is not None:
            return self.point.deviation
        return None if self.point.value is None else (self.point.value - self.origin) / self._one

    @property
    def lower(self) -> float | None:
        """Lower end of the band; an angle between axes is never below zero."""
        if self.value is None or self.expanded is None:
            return None
        return max(0.0, self.value - self.expanded) if self.is_angle else self.value - self.expanded

    @property
    def upper(self) -> float | None:
        """Upper end of the band."""
        return None if self.value is None or self.expanded is None else self.value + self.expanded

    @property
    def expanded(self) -> float | None:
        """U of the change; of a reference, of the value itself."""
        if self.point.expanded is not None:
            return self.point.expanded
        if self.point.upper is None or self.point.value is None:
            return None
        return (self.point.upper - self.point.value) / self._one

    @property
    def tolerance(self) -> float | None:
        """Largest allowed change; None where it is not judged."""
        if self.point.tolerance is None or self.point.reference is None:
            return None
        return self.point.tolerance / self._one

    @property
    def is_angle(self) -> bool:
        """Whether the value is the angle from the reference axis."""
        return self.point.parameter == "axis"

    @property
    def largest(self) -> float:
        """Largest size for which a chart of this point needs room."""
        return max(abs(self.value or 0.0), self.tolerance or 0.0)

    @property
    def _one(self) -> float:
        return (abs(self.origin) or 1.0) if self.point.parameter == "scale" else 1.0


def changes_of(points: Sequence[HistoryPoint], services: Sequence[Service]) -> tuple[MeasuredChange, ...]:
    """The changes of one parameter of one sensor, oldest first; without a reference, from its epoch's first value."""
    epochs = [sum(service.at <= point.at for service in services) for point in points]
    starts: dict[int, float] = {}
    for epoch, point in zip(epochs, points, strict=True):
        start = point.value if point.reference is None else point.reference
        if start is not None:
            starts.setdefault(epoch, start)
    return tuple(
        MeasuredChange(point, epoch, starts.get(epoch, 0.0) if point.reference is None else point.reference)
        for epoch, point in zip(epochs, points, strict=True)
    )


@dataclass(frozen=True)
class TrackKey:
    """A parameter of a sensor."""

    sensor: str
    kind: str
    parameter: str


Place = tuple[str, str, str]
"""A session, a sensor and a parameter."""


@dataclass(frozen=True, eq=False)
class Left:
    """Rest of a change without the part that a diagnosis explains."""

    change: list[float]
    sigma: list[float]
    """Standard uncertainty of the rest from the session itself."""
    dof: float | None
    part: list[float]
    """Part that was taken off; all SI or relative."""


NOTHING_EXPLAINED: dict[Place, Left] = {}
WORTH_TELLING = 0.1
"""Least share of the tolerance at which the part that a diagnosis explains is mentioned."""


@dataclass(frozen=True, eq=False)
class Histories:
    """Every parameter of a unit since its last break."""

    keys: tuple[TrackKey, ...]
    tracks: tuple[Track, ...]
    dates: tuple[tuple[datetime, ...], ...]
    """Dates of every track's sessions, the reference included."""
    left: Mapping[Place, Left] = field(default_factory=dict)
    """Rests of changes that a diagnosis explains in part."""

    def explained_in(self, session: str) -> tuple[tuple[TrackKey, float], ...]:
        """The changes of a session that a diagnosis explains, the lengths SI or relative, where worth telling."""
        found = ((key, track, self.left.get((session, key.sensor, key.parameter))) for key, track in self._tracks())
        sizes = ((key, track, hypot(*left.part)) for key, track, left in found if left is not None)
        return tuple((key, size) for key, track, size in sizes if size >= WORTH_TELLING * track.tolerance)

    def _tracks(self) -> Iterable[tuple[TrackKey, Track]]:
        return zip(self.keys, self.tracks, strict=True)


def histories(
    changes: Sequence[ChangeRow], references: Sequence[ReferenceRow], left: Mapping[Place, Left] = NOTHING_EXPLAINED
) -> Histories:
    """The histories in the order in which sensors and parameters were first judged; of changes that a diagnosis
    explains in part, only the rest.
    """
    groups = _groups(changes, references)
    dated = [_track(key, rows, reference, left) for key, (rows, reference) in groups.items()]
    return Histories(tuple(groups), tuple(track for track, _ in dated), tuple(at for _, at in dated), left)


Group = tuple[list[ChangeRow], ReferenceRow]
Measured = tuple[list[float], list[float]]
"""Change, and its uncertainty."""
Point = tuple[datetime, list[float], list[float], float | None, float | None]
"""Date, change, its uncertainty with its degrees of freedom, temperature."""


def type_evidence(found: Histories) -> dict[tuple[str, str], list[Evidence]]:
    """The evidence of each history, by kind of sensor and parameter."""
    by_place: dict[tuple[str, str], list[Evidence]] = {}
    for key, track in zip(found.keys, found.tracks, strict=True):
        by_place.setdefault((key.kind, key.parameter), []).append(evidence(track))
    return by_place


def _groups(changes: Sequence[ChangeRow], references: Sequence[ReferenceRow]) -> dict[TrackKey, Group]:
    """The changes of each parameter from one reference; of a sensor with several references the latest programme's."""
    first: dict[tuple[str, tuple[str, ...]], ReferenceRow] = {}
    for reference in references:
        first.setdefault((reference.block, comparable(reference.programme)), reference)
    groups: dict[TrackKey, Group] = {}
    for row in changes:
        counted_from = first.get((row.block, comparable(row.programme)))
        if counted_from is not None:
            key = TrackKey(row.sensor, row.kind, row.parameter)
            rows, known = groups.get(key, ([], counted_from))
            groups[key] = ([*rows, row], known) if known is counted_from else ([row], counted_from)
    return groups


def _track(
    key: TrackKey, rows: Sequence[ChangeRow], reference: ReferenceRow, left: Mapping[Place, Left]
) -> tuple[Track, tuple[datetime, ...]]:
    """The sessions of a parameter with its reference among them, in order of time.

    A change's degrees of freedom are those of both its sessions; the reference counts with the fewest.
    """
    fewest = min((row.dof for row in rows if row.dof is not None), default=None)
    still = ([0.0] * len(rows[-1].change), rows[-1].origin)
    judged: tuple[Measured, ...] = (still, *((row.change, row.own) for row in rows))
    sessions: tuple[tuple[ChangeRow | ReferenceRow, float | None], ...] = (
        (reference, fewest),
        *((row, row.dof) for row in rows),
    )
    explained = (left.get((row.session, key.sensor, key.parameter)) for row, _ in sessions)
    changes = zip(sessions, _as_measured(rows, reference) or judged, explained, strict=True)
    points = sorted((_point(row, change, dof, part) for (row, dof), change, part in changes), key=_date)
    start = points[0][0]
    track = Track(
        time=np.array([(at - start) / YEAR for at, *_ in points]),
        change=np.array([change for _, change, *_ in points]),
        sigma=np.array([sigma for _, _, sigma, *_ in points]),
        tolerance=rows[-1].tolerance,
        dof=np.array([np.inf if dof is None else dof for *_, dof, _ in points]),
        temperature=np.array([np.nan if warm is None else warm for *_, warm in points]),
    )
    return track, tuple(at for at, *_ in points)


def _point(row: ChangeRow | ReferenceRow, measured: Measured, dof: float | None, left: Left | None) -> Point:
    """One session's change, without the part that a diagnosis explains."""
    change, sigma = measured
    if left is None:
        return row.at, change, sigma, dof, row.temperature
    return row.at, np.subtract(change, left.part).tolist(), left.sigma, left.dof, row.temperature


def _as_measured(rows: Sequence[ChangeRow], reference: ReferenceRow) -> tuple[Measured, ...] | None:
    """The reference's change and those of the rows, without corrections, where the sessions span temperature; None for
    a parameter that does not follow it.

    The common part of all sensors is the one on which a majority agrees: where each sensor follows the temperature by a
    law of its own it differs at each temperature, and the rest follows none.
    """
    warm = np.array([reference.temperature, *(row.temperature for row in rows)], dtype=float)
    first = reference.u.get((rows[-1].sensor, rows[-1].parameter))
    if rows[-1].parameter not in FOLLOW or first is None or not shows_temperature(warm):
        return None
    points = [(row.value, row.reference, row.u) for row in rows]
    if any(None in point for point in points):
        return None
    values = np.array(points, dtype=float)
    unit = values[:, 1] if rows[-1].parameter == "scale" else np.ones(len(rows))
    change, u = (values[:, 0] - values[:, 1]) / unit, values[:, 2] / np.abs(unit)
    return (([0.0], [first / abs(unit[-1])]), *(([float(d)], [float(s)]) for d, s in zip(change, u, strict=True)))


def _date(point: Point) -> datetime:
    return point[0]
