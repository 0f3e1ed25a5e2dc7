"""The page of one unit: its verdict now, and the basis of it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from estimator.message import capitalised, say
from service.flags.pages import FlagCard, flag_cards
from service.flags.records import Flag
from service.fleet.condition import UnitSummary
from service.fleet.use import WORDS
from service.groups.sections import GroupSection
from service.judging.covered import CoveredTemperatures
from service.judging.records import Usable
from service.judging.temperature_words import covered_in_words
from service.judging.usable_words import next_in_words
from service.kit.failure import unit_failed
from service.kit.measures import NOISE, day_of, in_measure, number
from service.outlook.charts import ParameterCourse, TrackPoint, history_charts
from service.outlook.records import UnitOutlook
from service.outlook.words import NextCalibration, changes_of, next_calibration
from service.pages.courses import course_chart
from service.pages.unit.events import KINDS, STEPS, StageTable, UnitEvent, events_of, stage_table
from service.pages.unit.parameters import ParameterHead, parameter_heads
from service.pages.unit.remarks import Remarks
from service.pages.unit.report import UnitReport
from service.pages.unit.shares import ShareTable, share_table
from service.papers.found_and_left import FoundAndLeft
from service.sessions.charts import ChartSet
from service.sessions.lines import SessionLine, session_lines
from service.sessions.records import HistoryPoint
from service.sessions.states import RecordState
from service.sessions.words.conditions import NOT_JUDGED
from service.sessions.words.noise import MEANINGS, NAMES, grown, term_in_words
from service.units.records import Custody, CustodyStep, Note, Service


@dataclass(frozen=True)
class NoiseRow:
    """One session's sizes of one term, a cell a sensor."""

    session: str
    day: str
    iso: str
    cells: tuple[str, ...]


@dataclass(frozen=True)
class NoiseSection:
    """One term of all sensors of a kind."""

    anchor: str
    heading: str
    meaning: str
    charts: ChartSet
    sensors: tuple[str, ...]
    rows: tuple[NoiseRow, ...]
    """Rows, newest first."""


@dataclass(frozen=True)
class NoisePart:
    """Everything of noise."""

    grown: tuple[str, ...]
    """Terms that are larger than before, in a sentence each."""
    sections: tuple[NoiseSection, ...]
    undecided: tuple[str, ...]
    """Names of the terms that no session decides."""


def noise_part(points: Sequence[HistoryPoint], services: Sequence[Service], notes: Sequence[Note]) -> NoisePart | None:
    """The noise of a unit from its terms, oldest first; None where no session has any."""
    if not points:
        return None
    kinds = sorted({point.kind for point in points})
    sections, undecided = [], []
    for name in NAMES:
        for kind in kinds:
            of_name = [point for point in points if (point.parameter, point.kind) == (name, kind)]
            heading = say("{heading}, {kind}", heading=NAMES[name], kind=f"{kind}s") if len(kinds) > 1 else NAMES[name]
            if any(point.value is not None for point in of_name):
                sections.append(_noise_section(of_name, heading, services, notes))
            elif of_name:
                undecided.append(heading)
    return NoisePart(grown(points), tuple(sections), tuple(undecided))


def _noise_section(
    points: Sequence[HistoryPoint], heading: str, services: Sequence[Service], notes: Sequence[Note]
) -> NoiseSection:
    first = points[0]
    sensors = tuple(dict.fromkeys(point.sensor for point in points))
    decided = [sensor for sensor in sensors if any(p.value is not None for p in points if p.sensor == sensor)]
    tracks = [_track([p for p in points if p.sensor == sensor]) for sensor in decided]
    return NoiseSection(
        anchor=f"{first.parameter}-{first.kind}",
        heading=heading,
        meaning=MEANINGS[first.parameter],
        charts=history_charts(tracks, services, notes),
        sensors=sensors,
        rows=tuple(reversed([_row(list(group), sensors) for _, group in groupby(points, key=lambda p: p.session)])),
    )


def _track(points: Sequence[HistoryPoint]) -> ParameterCourse:
    first = points[0]
    measure = NOISE[first.kind, first.parameter]
    shown = tuple(
        TrackPoint(
            at=point.at,
            session=point.session,
            shown=in_measure(point.value, measure),
            lower=in_measure(point.lower, measure),
            upper=in_measure(point.upper, measure),
            limit_lower=None,
            limit_upper=None,
            epoch=0,
            text=term_in_words(point),
            condition=NOT_JUDGED,
        )
        for point in points
    )
    return ParameterCourse(f"{first.parameter}-{first.kind}", first.sensor, first.parameter, measure, shown)


def _row(points: Sequence[HistoryPoint], sensors: Sequence[str]) -> NoiseRow:
    cells = {point.sensor: term_in_words(point) for point in points}
    at = points[0].at
    return NoiseRow(points[0].session, day_of(at), at.isoformat(), tuple(cells.get(sensor, "–") for sensor in sensors))


@dataclass(frozen=True)
class UnitView:
    """Everything a unit's page shows."""

    report: UnitReport
    usable: Usable
    word: str
    """Permitted use: ``Do not use``."""
    action: str
    """Action that is due; where there is none, the date of the next calibration."""
    why: tuple[str, ...]
    """Reasons for the permitted use, and the course of events."""
    measured: str
    """Time, place and temperature of the session that decides; empty before the first."""
    due: str
    """Due date of the next calibration, where that does not lead."""
    worst: ChartSet | None
    """History of the parameter that sets the verdict; None where none was judged."""
    shares: ShareTable | None
    failed: str
    """Statement that the results from its latest records could not be computed, with the reason; empty otherwise."""
    parameters: tuple[ParameterHead, ...]
    """Worst first; what each holds is fetched when it is opened."""
    sessions: tuple[SessionLine, ...]
    reference: str
    """Reference for the next session, in words; empty when that becomes the reference itself."""
    covered: str
    """The temperatures that its calibrations cover."""
    flags: tuple[FlagCard, ...]
    """Flags, open ones first."""
    events: tuple[UnitEvent, ...]
    """Services and notes, newest first."""
    stages: StageTable | None
    """The unit as found and as left; None where it was never marked as found."""
    custody: tuple[Custody, ...]
    """Locations and custodians, the latest first."""
    types: tuple[str, ...]
    """Names of the types that it could be moved to."""
    steps: Mapping[CustodyStep, str]
    """Steps of custody in words."""
    kinds: tuple[tuple[str, str], ...]
    """Kinds of service: identifier and name."""
    next: NextCalibration | None
    """Outlook; None before a session was judged."""
    raw: bool
    """Whether the common motion of the whole block is left in."""
    noise: NoisePart | None
    """Noise at rest; None where no session was sent as a raw log with rests."""
    group: GroupSection | None
    """Joint diagnosis of its sessions; None where that is not made of its current records."""
    remarks: Remarks | None
    """Files that people attached; None where the page is made without a service."""
    follow: int | None
    """Seconds after which the page looks again whether its dates are worked out; None where they are."""


def unit_page(
    report: UnitReport,
    latest: Sequence[HistoryPoint],
    usable: Usable,
    *,
    raw: bool = False,
    noise: Sequence[HistoryPoint] = (),
    worst: Sequence[HistoryPoint] = (),
    flags: Sequence[Flag] = (),
    notes: Sequence[Note] = (),
    pair: FoundAndLeft | None = None,
    outlook: UnitOutlook | None = None,
    group: GroupSection | None = None,
    follow: int | None = None,
    said: Remarks | None = None,
    history_of_custody: Sequence[Custody] = (),
    temperatures: CoveredTemperatures | None = None,
    types: Sequence[str] = (),
) -> UnitView:
    """The page of a unit with the latest of every parameter, the history of its ``worst`` one, flags and notes, as
    found and as left, and when it must come back."""
    services = [service for service in report.services if service.state is RecordState.ACCEPTED]
    heads = parameter_heads(latest, report.summary.worst_parameter)
    coming = None if outlook is None else next_calibration(outlook, usable.as_of)
    return UnitView(
        report=report,
        usable=usable,
        word=WORDS[usable.answer],
        action=capitalised(usable.action) or next_in_words(usable),
        why=tuple(_why(usable, report.summary, outlook)),
        measured=_measured(report),
        due=next_in_words(usable) if usable.action and usable.due else "",
        worst=course_chart(worst, services, outlook) if worst else None,
        shares=share_table(latest, heads),
        failed=unit_failed(report.summary.failed) if report.summary.failed else "",
        parameters=heads,
        sessions=session_lines(report.sessions),
        reference=_reference(report),
        covered=covered_in_words(temperatures),
        flags=flag_cards(flags),
        events=events_of((*report.services, *report.withdrawn_services), notes, report.withdrawals),
        stages=stage_table(pair),
        kinds=tuple(KINDS.items()),
        next=coming,
        raw=raw,
        noise=noise_part(noise, report.services, [note for note in notes if note.withdrawal is None]),
        group=group,
        remarks=said,
        custody=tuple(history_of_custody),
        types=tuple(types),
        steps=STEPS,
        follow=follow,
    )


def _why(usable: Usable, unit: UnitSummary, outlook: UnitOutlook | None) -> Iterator[str]:
    """The reason, and where the unit must not be used how the parameter came there that the verdict rests on."""
    yield usable.objection or usable.why
    for trend in () if usable.usable or outlook is None else outlook.trends:
        if (trend.sensor, trend.parameter) == (unit.worst_sensor, unit.worst_parameter):
            yield from changes_of(trend)


def _measured(report: UnitReport) -> str:
    latest = next((s for s in report.sessions if s.id == report.summary.last_session), None)
    if latest is None:
        return ""
    parts = {"day": day_of(latest.started_at), "stand": latest.stand or "", "warm": ""}
    if latest.temperature is not None:
        parts["warm"] = say(", {temperature} °C", temperature=number(latest.temperature, 1))
    return say("Measured {day} on {stand}{warm}." if latest.stand else "Measured {day}{warm}.", **parts)


def _reference(report: UnitReport) -> str:
    """The date of the reference, or its name where it is not among the latest sessions."""
    if report.reference_session is None:
        return ""
    dates = {s.id: day_of(s.started_at) for s in report.sessions}
    return dates.get(
        report.reference_session, say("session {reference_session}", reference_session=report.reference_session[:8])
    )
