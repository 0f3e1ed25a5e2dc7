"""The fleet on paper: one page that says how it stands, then a section for every unit that is not fit."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeVar

from service.charts.fleet import fleet_chart
from service.charts.history import history_charts
from service.charts.tracks import tracks_of
from service.measures import COVERAGE, deviation_measure, measured, number, signed
from service.records.decision import Decision, Verdict
from service.records.event import Service
from service.records.history import HistoryPoint
from service.records.outlook import ParameterTrend, UnitOutlook
from service.records.unit import UnitSummary
from service.reports.moved import Moved, moved
from service.reports.pictures import picture
from service.reports.typeset import typeset
from service.storage.store import Store
from service.views.fleet_report import FleetReport
from service.words.conditions import REFERENCE, Condition, condition_of
from service.words.names import day_of

MOST_RANKED = 100
MOST_SECTIONS = 40
MOST_NOTICES = 8
"""Units that are listed as overdue, and parameters that stand out."""
STANDS_OUT, SIGNIFICANT = 5.0, 0.001
"""Distance from the type's other units, in their robust spread, and the chance of such a rate without a drift."""
MOST_MOVED = 8
"""Parameters of one unit that are listed."""
T = TypeVar("T")
WIDE, NARROW = 700, 330
"""Of drawn charts, pixels."""
NOT_FIT = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL, Verdict.UNDECIDABLE)


@dataclass(frozen=True)
class Count:
    """How many units are in one condition."""

    condition: Condition
    count: int


@dataclass(frozen=True)
class Line:
    """One unit in the ranking."""

    unit: str
    unit_type: str
    condition: Condition
    worst: str
    used: str
    """Share of the tolerance, uncertainty included."""
    last: str
    simulated: bool


@dataclass(frozen=True)
class Section:
    """One unit that is not fit."""

    line: Line
    reason: str
    diagnosis: str
    moved: tuple[Moved, ...]
    """The parameters that did not pass, worst first."""
    more: int
    """How many others did not."""
    history: str
    """SVG of the worst parameter through time; empty where there is none."""
    history_of: str


@dataclass(frozen=True)
class Notice:
    """One unit that is overdue, or that stands out."""

    unit: str
    text: str


@dataclass(frozen=True)
class FleetPaper:
    """Everything that the paper says."""

    day: str
    total: int
    simulated: int
    counts: tuple[Count, ...]
    chart: str
    overdue: tuple[Notice, ...]
    more_overdue: int
    standing_out: tuple[Notice, ...]
    """Parameters that drift otherwise than those of the type's other units."""
    ranked: tuple[Line, ...]
    sections: tuple[Section, ...]
    not_fit: int
    software: str


def fleet_pdf(store: Store, report: FleetReport) -> bytes:
    """The report as PDF: two pages and a section for each unit that is not fit, of the worst ones if they are many."""
    return typeset("fleet.typ", fleet_paper(store, report), report.at)


def fleet_paper(store: Store, report: FleetReport) -> FleetPaper:
    """What the paper says."""
    not_fit = [unit for unit in report.units if _is_not_fit(unit)]
    judged = [unit for unit in report.units if unit.margin is not None and _condition(unit) is not REFERENCE]
    overdue = sorted((o for o in report.outlooks if o.overdue), key=lambda o: (o.due or report.at, o.serial))
    chart = fleet_chart(report.units)
    return FleetPaper(
        day=day_of(report.at),
        total=report.condition.units,
        simulated=report.condition.simulated,
        counts=tuple(Count(condition_of(v), n) for v, n in reversed(report.condition.verdicts.items())),
        chart=picture(chart, chart.panels[0], WIDE) if judged else "",
        overdue=tuple(Notice(o.serial, _since(o, report)) for o in overdue[:MOST_NOTICES]),
        more_overdue=max(0, len(overdue) - MOST_NOTICES),
        standing_out=_standing_out(report),
        ranked=tuple(_line(unit) for unit in report.units[:MOST_RANKED]),
        sections=_sections(store, not_fit[:MOST_SECTIONS]),
        not_fit=len(not_fit),
        software=report.software,
    )


def _since(outlook: UnitOutlook, report: FleetReport) -> str:
    """``since 3 Mar 2026 (263 days)``."""
    due = outlook.due or report.at
    return f"since {day_of(due)} ({(report.at - due).days} days)"


def _standing_out(report: FleetReport) -> tuple[Notice, ...]:
    found = [
        (abs(trend.population_z), outlook.serial, trend)
        for outlook in report.outlooks
        for trend in outlook.trends
        if trend.population_z is not None and abs(trend.population_z) > STANDS_OUT and trend.significance < SIGNIFICANT
    ]
    furthest = sorted(found, key=lambda entry: (-entry[0], entry[1], entry[2].sensor, entry[2].parameter))
    return tuple(Notice(serial, _drift(trend)) for _, serial, trend in furthest[:MOST_NOTICES])


def _drift(trend: ParameterTrend) -> str:
    """``A6 bias drifts +62 ± 4 µg a year``."""
    unit = deviation_measure(trend.kind, trend.parameter, abs(trend.rate_per_year))
    write = measured if trend.parameter == "axis" else signed
    rate = write(trend.rate_per_year, COVERAGE * trend.rate_sigma, unit)
    return f"{trend.sensor} {trend.parameter} drifts {rate} a year"


def _condition(unit: UnitSummary) -> Condition:
    return condition_of(unit.verdict, is_reference=unit.is_reference)


def _is_not_fit(unit: UnitSummary) -> bool:
    return unit.verdict in NOT_FIT and _condition(unit) is not REFERENCE


def _line(unit: UnitSummary) -> Line:
    return Line(
        unit=unit.serial,
        unit_type=unit.unit_type,
        condition=_condition(unit),
        worst=f"{unit.worst_sensor or ''} {unit.worst_parameter or ''}".strip(),
        used="" if unit.margin is None else f"{number(100 * (1 - unit.margin), 0)} %",
        last="" if unit.last_at is None else day_of(unit.last_at),
        simulated=unit.simulated,
    )


def _sections(store: Store, units: list[UnitSummary]) -> tuple[Section, ...]:
    """Sections of units, with three queries for all of them."""
    serials = tuple(unit.serial for unit in units)
    decisions = _grouped((serial, decision) for serial, _, decision in store.fleet_rows.latest_decisions(serials))
    points = _grouped(store.fleet_rows.worst_histories(serials))
    services = store.fleet_rows.services(serials)
    return tuple(
        _section(unit, decisions.get(unit.serial, []), points.get(unit.serial, []), services) for unit in units
    )


def _grouped(rows: Iterable[tuple[str, T]]) -> dict[str, list[T]]:
    found: dict[str, list[T]] = {}
    for serial, row in rows:
        found.setdefault(serial, []).append(row)
    return found


def _section(
    unit: UnitSummary, decisions: list[Decision], points: list[HistoryPoint], services: tuple[Service, ...]
) -> Section:
    line, wrong = _line(unit), _worst_first(decisions)
    history = _history(points, tuple(service for service in services if service.unit == unit.serial))
    return Section(
        line=line,
        reason=unit.reason,
        diagnosis=unit.diagnosis,
        moved=tuple(moved(decision) for decision in wrong[:MOST_MOVED]),
        more=max(0, len(wrong) - MOST_MOVED),
        history=history,
        history_of=line.worst if history else "",
    )


def _worst_first(decisions: list[Decision]) -> list[Decision]:
    wrong = [d for d in decisions if d.verdict is not Verdict.PASS]
    return sorted(wrong, key=lambda d: (-d.verdict.severity, d.margin or 0.0))


def _history(points: list[HistoryPoint], services: tuple[Service, ...]) -> str:
    tracks = tracks_of(points, services)
    if not tracks or len(points) < 2:
        return ""
    charts = history_charts(tracks[0], services)
    return picture(charts, charts.panels[0], NARROW)
