"""The fleet on paper: one page that says how it stands, then a section for every unit that is not fit."""

from dataclasses import dataclass

from estimator.wording import counted
from service.charts.fleet import fleet_chart
from service.languages.language import Language
from service.measures import COVERAGE, deviation_measure, measured, signed
from service.records.decision import Verdict
from service.records.fleet import NOT_JUDGED, FleetQuery, Placed, Population, Tally
from service.records.outlook import DueDate
from service.records.unit import FleetCondition
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
STANDS_OUT = 5.0
"""Distance from the type's other units, in their robust spread."""
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
    judged = [t for t in report.tallies if t.bar != NOT_JUDGED and _condition(t) is not REFERENCE]
    overdue = [one for one in store.outlooks.due(MOST_NOTICES) if one.at < report.at]
    chart = fleet_chart(report.tallies)
    return FleetPaper(
        day=day_of(report.at),
        total=report.condition.units,
        simulated=report.condition.simulated,
        counts=_counts(report.condition),
        chart=picture(chart, chart.panels[0], WIDTH) if judged else "",
        overdue=tuple(Notice(one.unit, _since(one, report)) for one in overdue),
        more_overdue=report.overdue - len(overdue),
        standing_out=_standing_out(store),
        ranked=tuple(line_of(unit) for unit in store.fleet.units(FleetQuery(limit=MOST_RANKED))),
        sections=sections_of(store, store.fleet.units(FleetQuery(unfit=True, limit=MOST_SECTIONS))),
        not_fit=sum(tally.units for tally in report.tallies if _is_not_fit(tally)),
        software=report.software,
    )


def _counts(fleet: FleetCondition) -> tuple[Count, ...]:
    """Worst first."""
    found = reversed(fleet.verdicts.items())
    return tuple(Count(condition_of(verdict), count, fleet.reserved.get(verdict, 0)) for verdict, count in found)


def _since(one: DueDate, report: FleetReport) -> str:
    """``since 3 Mar 2026 (263 days)``."""
    due = one.at
    return f"since {day_of(due)} ({counted((report.at - due).days, 'day')})"


def _standing_out(store: Store) -> tuple[Notice, ...]:
    """The furthest out of their types, of those whose drift chance does not explain."""
    populations = store.populations.most_evident(MOST_NOTICES)
    found = [(one, own) for own in populations for one in own.evident if abs(one.z) > STANDS_OUT]
    furthest = sorted(found, key=lambda pair: (-abs(pair[0].z), pair[0].serial, pair[0].sensor, pair[1].parameter))
    return tuple(Notice(one.serial, _drift(one, own)) for one, own in furthest[:MOST_NOTICES])


def _drift(one: Placed, own: Population) -> str:
    """``A6 bias drifts +62 ± 4 µg a year``."""
    rate, sigma = one.value * one.tolerance, one.sigma * one.tolerance
    unit = deviation_measure(own.kind, own.parameter, abs(rate))
    write = measured if own.parameter == "axis" else signed
    return f"{one.sensor} {own.parameter} drifts {write(rate, COVERAGE * sigma, unit)} a year"


def _condition(tally: Tally) -> Condition:
    return condition_of(tally.verdict, is_reference=tally.is_reference)


def _is_not_fit(tally: Tally) -> bool:
    return tally.verdict in NOT_FIT and _condition(tally) is not REFERENCE
