"""The page of one unit: its verdict now, and how every parameter of every sensor got there."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.message import say
from service.flags.records import Flag
from service.kit.failure_words import unit_failed
from service.kit.names import day_of, heading
from service.outlook.charts import history_charts
from service.outlook.records import ParameterTrend, UnitOutlook
from service.outlook.tracks import Track, TrackPoint, tolerance_text, tracks_of
from service.outlook.words.outlook import NextCalibration, next_calibration
from service.pages.flags import FlagCard, flag_cards
from service.pages.group.sections import GroupSection
from service.pages.unit.events import KINDS, Event, StageTable, events_of, stage_table
from service.pages.unit.noise import NoisePart, noise_part, without_noise
from service.pages.unit.records import UnitReport
from service.pages.unit.remarks import Remarks
from service.papers.found_and_left import FoundAndLeft
from service.sessions.charts import ChartSet
from service.sessions.lines import SessionLine, session_lines
from service.sessions.records import HistoryPoint
from service.sessions.words.conditions import NOT_JUDGED, Condition, condition_of
from service.units.records import Note, Service

MEANINGS = {
    "scale": "Change of the scale factor from the reference of its time.",
    "bias": "Change of the zero offset from the reference of its time.",
    "quadratic": "Change of the quadratic nonlinearity from the reference of its time.",
    "axis": "Angle between the input axis and its direction in the reference of its time.",
    "misalignment": "Change of the input axis' turn toward a turntable's axis from the reference of its time.",
}
"""What the charts of a parameter show."""
TOGETHER = {"axis": "turn", "scale": "change"}
"""What a whole block does to a parameter."""


@dataclass(frozen=True)
class TableRow:
    """One session's values of one parameter, a cell a sensor; None where a sensor was not in the session."""

    session: str
    day: str
    iso: str
    cells: tuple[TrackPoint | None, ...]


@dataclass(frozen=True)
class ParameterSection:
    """One parameter of all sensors of a kind: charts, and the same as a table."""

    anchor: str
    heading: str
    meaning: str
    together: str
    """What of the whole block is taken off, in a word; empty where nothing ever is."""
    unit: str
    tolerance: str
    worst: Condition
    charts: ChartSet
    sensors: tuple[str, ...]
    rows: tuple[TableRow, ...]


@dataclass(frozen=True)
class UnitPage:
    """Everything a unit's page shows."""

    report: UnitReport
    condition: Condition
    failed: str
    """That what follows from its latest records could not be worked out, and why; empty else."""
    sections: tuple[ParameterSection, ...]
    sessions: tuple[SessionLine, ...]
    reference: str
    """What the next session is judged against, in words; empty when it becomes the reference itself."""
    drawn: int
    """How many sessions, the newest ones, the charts show."""
    flags: tuple[FlagCard, ...]
    """Open ones first."""
    events: tuple[Event, ...]
    """Services and notes, newest first."""
    stages: StageTable | None
    """None where the unit was never marked as found."""
    kinds: tuple[tuple[str, str], ...]
    """What can be done to a unit: identifier and name."""
    next: NextCalibration | None
    """None before a session was judged."""
    raw: bool
    """Whether what the whole block did is left in."""
    noise: NoisePart | None
    """None where no session was sent as a raw log with rests."""
    group: GroupSection | None
    """What its sessions show together; None where that is not made of its records of now."""
    said: Remarks | None
    """Files that people attached; None where the page is made without a service."""
    follow: int | None
    """Seconds after which the page looks again whether its dates are worked out; None where they are."""


def unit_page(
    report: UnitReport,
    history: Sequence[HistoryPoint],
    *,
    now: datetime,
    raw: bool = False,
    flags: Sequence[Flag] = (),
    notes: Sequence[Note] = (),
    pair: FoundAndLeft | None = None,
    outlook: UnitOutlook | None = None,
    group: GroupSection | None = None,
    follow: int | None = None,
    said: Remarks | None = None,
) -> UnitPage:
    """The page of a unit with its history, flags and notes, as found and as left, and when it must come back."""
    trends = () if outlook is None or raw else outlook.trends
    valid = tuple(note for note in notes if note.withdrawal is None)
    history, terms = without_noise(history)
    groups = tracks_of(history, report.services)
    kinds = {point.kind for point in history}
    return UnitPage(
        report=report,
        failed=unit_failed(report.summary.failed) if report.summary.failed else "",
        condition=condition_of(report.summary.verdict, is_reference=report.summary.is_reference),
        sections=tuple(_section(tracks, report.services, valid, trends, several=len(kinds) > 1) for tracks in groups),
        sessions=session_lines(report.sessions),
        reference=_reference(report),
        drawn=len({point.session for point in history}),
        flags=flag_cards(flags),
        events=events_of((*report.services, *report.withdrawn_services), notes, report.withdrawals),
        stages=stage_table(pair),
        kinds=tuple(KINDS.items()),
        next=None if outlook is None else next_calibration(outlook, now),
        raw=raw,
        noise=noise_part(terms, report.services, valid),
        group=group,
        said=said,
        follow=follow,
    )


def _reference(report: UnitReport) -> str:
    """The date of the reference, or its name where it is not among the latest sessions."""
    if report.reference_session is None:
        return ""
    dates = {s.id: day_of(s.started_at) for s in report.sessions}
    return dates.get(
        report.reference_session, say("session {reference_session}", reference_session=report.reference_session[:8])
    )


def _section(
    tracks: Sequence[Track],
    services: Sequence[Service],
    notes: Sequence[Note],
    trends: Sequence[ParameterTrend],
    several: bool,
) -> ParameterSection:
    parameter = tracks[0].parameter
    kind = tracks[0].name.rpartition("-")[2]
    latest = [track.points[-1].condition for track in tracks]
    judged = [condition for condition in latest if condition is not NOT_JUDGED]
    return ParameterSection(
        anchor=tracks[0].name,
        heading=say("{heading}, {kind}", heading=heading(parameter), kind=f"{kind}s")
        if several
        else heading(parameter),
        meaning=MEANINGS[parameter],
        together=TOGETHER.get(parameter, ""),
        unit=tracks[0].unit.label,
        tolerance=tolerance_text(tracks[0]),
        worst=min(judged, key=lambda c: c.rank, default=NOT_JUDGED),
        charts=history_charts(tracks, services, notes, trends),
        sensors=tuple(track.sensor for track in tracks),
        rows=_rows(tracks),
    )


def _rows(tracks: Sequence[Track]) -> tuple[TableRow, ...]:
    """Sessions newest first, sensors across."""
    found = [{p.session: p for p in track.points} for track in tracks]
    sessions = {p.session: p.at for track in tracks for p in track.points}
    return tuple(
        TableRow(session, day_of(at), at.isoformat(), tuple(points.get(session) for points in found))
        for session, at in sorted(sessions.items(), key=lambda item: item[1], reverse=True)
    )
