"""The history of every parameter of a unit's sensors: a head on the unit's page, and a page of its own."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from estimator.allan.results import TERMS
from estimator.message import say
from service.kit.measures import day_of, heading
from service.outlook.charts import ParameterCourse, TrackPoint, history_charts, judged_as, tolerance_text, tracks_of
from service.outlook.records import UnitOutlook
from service.outlook.rules.thinned import LISTED
from service.sessions.charts import ChartSet
from service.sessions.records import ALL_PARAMETERS, HistoryPoint
from service.sessions.states import RecordState
from service.sessions.words.conditions import NOT_JUDGED, Condition
from service.units.records import UnitEvents

PARAMETER_MEANINGS = {
    "scale": "Change of the scale factor since the reference of its epoch.",
    "bias": "Change of the bias since the reference of its epoch.",
    "quadratic": "Change of the quadratic term since the reference of its epoch.",
    "axis": "Angle between the input axis and its direction in the reference of its epoch.",
    "misalignment": "Change of the input axis's misalignment to the turn axis since the reference of its epoch.",
}
"""Meanings of the charts, by parameter."""
TOGETHER = {"axis": "turn", "scale": "change"}
"""Common change of a whole block, by parameter."""


@dataclass(frozen=True)
class ParameterHead:
    """One parameter of all sensors of a kind, as it is now."""

    parameter: str
    kind: str
    heading: str
    worst: Condition

    @property
    def anchor(self) -> str:
        """Name of the parameter and kind in addresses."""
        return f"{self.parameter}-{self.kind}"


@dataclass(frozen=True)
class TableRow:
    """One session's values of one parameter, a cell a sensor; None where a sensor was not in the session."""

    session: str
    day: str
    iso: str
    cells: tuple[TrackPoint | None, ...]


@dataclass(frozen=True)
class ParameterPage:
    """One parameter of all sensors of a kind: charts, and the same as a table."""

    serial: str
    head: ParameterHead
    raw: bool
    """Whether the common motion of the whole block is left in."""
    meaning: str
    together: str
    """Common change of the whole block that is taken off, in a word; empty where there never is one."""
    tolerance: str
    charts: ChartSet
    sensors: tuple[str, ...]
    rows: tuple[TableRow, ...]
    """Rows of the newest sessions."""
    is_cut: bool
    """Whether sessions before these are drawn."""
    newest: int | None
    """Number of sessions, the newest ones, that are drawn; None where all are."""
    is_thinned: bool
    """Whether the charts leave out sessions that others cover."""


def parameter_heads(latest: Sequence[HistoryPoint], worst: str | None) -> tuple[ParameterHead, ...]:
    """The heads of all parameters from the newest point of each, without the terms of noise; by condition, among equals
    the parameter nearest to its tolerance leads.
    """
    groups: dict[tuple[int, str], list[HistoryPoint]] = {}
    for point in latest:
        if point.parameter not in TERMS:
            groups.setdefault((ALL_PARAMETERS.index(point.parameter), point.kind), []).append(point)
    several = len({kind for _, kind in groups}) > 1
    heads = [_head(groups[key], several) for key in sorted(groups)]
    return tuple(sorted(heads, key=lambda head: (head.worst.rank, head.parameter != worst)))


def _head(points: Sequence[HistoryPoint], several: bool) -> ParameterHead:
    parameter, kind = points[0].parameter, points[0].kind
    name, judged = heading(parameter), [found for found in map(judged_as, points) if found is not NOT_JUDGED]
    return ParameterHead(
        parameter,
        kind,
        heading=say("{heading}, {kind}", heading=name, kind=f"{kind}s") if several else name,
        worst=min(judged, key=lambda condition: condition.rank, default=NOT_JUDGED),
    )


def parameter_page(
    serial: str,
    head: ParameterHead,
    points: Sequence[HistoryPoint],
    most: int,
    events: UnitEvents,
    outlook: UnitOutlook | None,
    *,
    raw: bool,
) -> ParameterPage:
    """The charts and the table of at most so many points of one parameter."""
    services = [service for service in events.services if service.state is RecordState.ACCEPTED]
    notes = [note for note in events.notes if note.withdrawal is None]
    trends = () if outlook is None or raw else outlook.trends
    (tracks,) = tracks_of(points, services)
    rows = tuple(islice(_rows(tracks), LISTED + 1))
    worst_first = sorted(tracks, key=lambda track: track.points[-1].condition.rank)
    return ParameterPage(
        serial,
        head,
        raw,
        meaning=PARAMETER_MEANINGS[head.parameter],
        together=TOGETHER.get(head.parameter, ""),
        tolerance=tolerance_text(tracks[0]),
        charts=history_charts(worst_first, services, notes, trends),
        sensors=tuple(track.sensor for track in tracks),
        rows=rows[:LISTED],
        is_cut=len(rows) > LISTED,
        newest=len({point.session for point in points}) if len(points) > most - len(tracks) else None,
        is_thinned=sum(point.is_drawn for track in tracks for point in track.points) < len(points),
    )


def _rows(tracks: Sequence[ParameterCourse]) -> Iterator[TableRow]:
    """Sessions newest first, sensors across."""
    found = [{p.session: p for p in track.points} for track in tracks]
    sessions = {p.session: p.at for track in tracks for p in track.points}
    for session, at in sorted(sessions.items(), key=lambda item: item[1], reverse=True):
        yield TableRow(session, day_of(at), at.isoformat(), tuple(points.get(session) for points in found))
