"""The fleet on paper: one page that says how it stands, then a section for every unit that is not fit."""

from dataclasses import dataclass

from service.charts.fleet import fleet_chart
from service.languages.language import Language
from service.measures import COVERAGE, deviation_measure, measured, signed
from service.records.decision import Verdict
from service.records.outlook import ParameterTrend, UnitOutlook
from service.records.unit import FleetCondition, UnitSummary
from service.reports.fleet_sections import Line, Section, line_of, sections_of
from service.reports.pictures import picture
from service.reports.typeset import typeset
from service.storage.store import Store
from service.views.fleet_report import FleetReport
from service.words.conditions import REFERENCE, Condition, condition_of
from service.words.names import day_of

MOST_RANKED = 100
"""Lines of the ranking: two pages, worst first; the workbook has all units."""
MOST_SECTIONS = 40
"""Units with a section of their own, two to three on a page."""
MOST_NOTICES = 8
"""Units that are listed as overdue, and parameters that stand out."""
STANDS_OUT, SIGNIFICANT = 5.0, 0.001
"""Distance from the type's other units, in their robust spread, and the chance of such a rate without a drift."""
WIDTH = 700
"""Of the drawn chart, pixels: the whole page."""
NOT_FIT = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL, Verdict.UNDECIDABLE)
"""Verdicts that somebody must act on: these units get a section."""


@dataclass(frozen=True)
class Count:
    """How many units are in one condition."""

    condition: Condition
    count: int
    reserved: int
    """Of how many of them the verdict is said with a reservation."""


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


def fleet_pdf(store: Store, report: FleetReport, language: Language = Language.ENGLISH) -> bytes:
    """The report as PDF: two pages and a section for each unit that is not fit, of the worst ones if they are many."""
    return typeset("fleet.typ", fleet_paper(store, report), report.at, language)


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
        counts=_counts(report.condition),
        chart=picture(chart, chart.panels[0], WIDTH) if judged else "",
        overdue=tuple(Notice(o.serial, _since(o, report)) for o in overdue[:MOST_NOTICES]),
        more_overdue=max(0, len(overdue) - MOST_NOTICES),
        standing_out=_standing_out(report),
        ranked=tuple(line_of(unit) for unit in report.units[:MOST_RANKED]),
        sections=sections_of(store, not_fit[:MOST_SECTIONS]),
        not_fit=len(not_fit),
        software=report.software,
    )


def _counts(fleet: FleetCondition) -> tuple[Count, ...]:
    """Worst first."""
    found = reversed(fleet.verdicts.items())
    return tuple(Count(condition_of(verdict), count, fleet.reserved.get(verdict, 0)) for verdict, count in found)


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
