"""The fleet on paper: how it stands, then a section for every unit that is not fit."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from estimator.message import joined, say
from estimator.wording import counted
from service.fleet.condition import UnitSummary
from service.fleet.records import FleetQuery, Tally
from service.fleet.rows_store import FleetRows
from service.fleet.store import Fleet
from service.fleet.use import COUNT_WORDS, TONES, counted_uses
from service.judging.records import Usable
from service.judging.usable_reading import usable_of
from service.kit.measures import COVERAGE, day_of, deviation_measure, measured, signed
from service.languages.language import Language
from service.outlook.charts import history_charts, tracks_of
from service.outlook.populations import Placed, Population
from service.outlook.records import DueDate
from service.outlook.store import Outlooks, Populations
from service.papers.fleet.charts import fleet_chart, is_drawn
from service.papers.fleet.report import FleetReport
from service.papers.found_and_left import JudgedChange, moved
from service.papers.typeset import picture, typeset
from service.sessions.decision import Decision, Verdict
from service.sessions.records import HistoryPoint
from service.sessions.words.conditions import REFERENCE, but, condition_of
from service.storage.queries import Store
from service.units.records import Service

MOST_MOVED = 8
"""Parameters of one unit that are listed."""
SECTION_WIDTH = 330
"""Width of a drawn history, pixels: half of the page."""
T = TypeVar("T")


@dataclass(frozen=True)
class FleetLine:
    """One unit in the ranking."""

    unit: str
    unit_type: str
    but: str
    """Reservations of the verdict; empty where it is plain."""
    tone: str
    """Colour and mark of its use."""
    use: str
    """Permitted use of the unit, and the action that is due."""
    worst: str
    used: str
    """Share of the tolerance, uncertainty included."""
    last: str
    simulated: bool


@dataclass(frozen=True)
class FleetSection:
    """One unit that is not fit."""

    line: FleetLine
    reason: str
    diagnosis: str
    moved: tuple[JudgedChange, ...]
    """The parameters that did not pass, worst first."""
    more: int
    """Number of further parameters that did not pass."""
    history: str
    """SVG of the worst parameter through time; empty where there is none."""
    history_of: str


def line_of(unit: UnitSummary, usable: Usable) -> FleetLine:
    """How the unit stands, in people's units."""
    return FleetLine(
        unit=unit.serial,
        unit_type=unit.unit_type,
        tone=TONES[usable.answer],
        but=but(unit.reservations),
        use=usable.use,
        worst=joined(" ", filter(None, (unit.worst_sensor, unit.worst_parameter))),
        used="" if unit.used is None else unit.used.words,
        last="" if unit.last_at is None else day_of(unit.last_at),
        simulated=unit.simulated,
    )


def sections_of(
    store: Store, units: Sequence[UnitSummary], uses: Mapping[str, Usable], language: Language
) -> tuple[FleetSection, ...]:
    """Sections of units, with three queries for all of them."""
    serials = tuple(unit.serial for unit in units)
    decisions = _grouped((serial, decision) for serial, _, decision in FleetRows(store).latest_decisions(serials))
    points = _grouped(FleetRows(store).worst_histories(serials))
    services = FleetRows(store).services(serials)
    return tuple(
        _section(
            line_of(unit, uses[unit.serial]),
            unit,
            decisions.get(unit.serial, []),
            points.get(unit.serial, []),
            services,
            language,
        )
        for unit in units
    )


def _grouped(rows: Iterable[tuple[str, T]]) -> dict[str, list[T]]:
    found: dict[str, list[T]] = {}
    for serial, row in rows:
        found.setdefault(serial, []).append(row)
    return found


def _section(
    line: FleetLine,
    unit: UnitSummary,
    decisions: list[Decision],
    points: list[HistoryPoint],
    services: tuple[Service, ...],
    language: Language,
) -> FleetSection:
    wrong = _worst_first(decisions)
    history = _history(points, tuple(service for service in services if service.unit == unit.serial), language)
    return FleetSection(
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


def _history(points: list[HistoryPoint], services: tuple[Service, ...], language: Language) -> str:
    tracks = tracks_of(points, services)
    if not tracks or len(points) < 2:
        return ""
    charts = history_charts(tracks[0], services)
    return picture(charts, charts.panels[0], SECTION_WIDTH, language)


MOST_RANKED = 100
"""Lines of the ranking: two pages, worst first; the workbook has all units."""
MOST_SECTIONS = 40
"""Units with a section each, two to three on a page."""
MOST_NOTICES = 8
"""Units that are listed as overdue, and parameters that stand out."""
STANDS_OUT = 5.0
"""Distance from the type's other units, in their robust spread."""
WIDTH = 700
"""Width of the drawn chart, pixels: the whole page."""
NOT_FIT = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL, Verdict.UNDECIDABLE)
"""Verdicts that somebody must act on: these units get a section."""


@dataclass(frozen=True)
class PaperNotice:
    """One unit that is overdue, or that stands out."""

    unit: str
    text: str


@dataclass(frozen=True)
class PaperCount:
    """Number of units with one answer to whether they may be used."""

    tone: str
    count: int
    words: str


@dataclass(frozen=True)
class FleetPaper:
    """Everything that the paper says."""

    day: str
    total: int
    simulated: int
    counts: tuple[PaperCount, ...]
    """Every unit once, those that must not be used first."""
    chart: str
    overdue: tuple[PaperNotice, ...]
    more_overdue: int
    standing_out: tuple[PaperNotice, ...]
    """Parameters that drift otherwise than those of the type's other units."""
    ranked: tuple[FleetLine, ...]
    sections: tuple[FleetSection, ...]
    not_fit: int
    software: str


def fleet_pdf(store: Store, report: FleetReport, language: Language = Language.ENGLISH) -> bytes:
    """The report as PDF: two pages and a section for each unit that is not fit, of the worst ones if they are many."""
    return typeset("fleet.typ", fleet_paper(store, report, language), report.at, language)


def fleet_paper(store: Store, report: FleetReport, language: Language) -> FleetPaper:
    """The contents of the paper."""
    judged = any(is_drawn(tally) for tally in report.tallies)
    overdue = [due for due in Outlooks(store).due(MOST_NOTICES) if due.at < report.at]
    chart = fleet_chart(report.tallies)
    ranked = Fleet(store).units(FleetQuery(limit=MOST_RANKED))
    unfit = Fleet(store).units(FleetQuery(unfit=True, limit=MOST_SECTIONS))
    uses = usable_of(store, (*ranked, *unfit), report.at)
    return FleetPaper(
        day=day_of(report.at),
        total=report.condition.units,
        simulated=report.condition.simulated,
        counts=tuple(PaperCount(TONES[use], count, COUNT_WORDS[use]) for use, count in counted_uses(report.uses)),
        chart=picture(chart, chart.panels[0], WIDTH, language) if judged else "",
        overdue=tuple(PaperNotice(due.unit, _since(due, report)) for due in overdue),
        more_overdue=report.overdue - len(overdue),
        standing_out=_standing_out(store),
        ranked=tuple(line_of(unit, uses[unit.serial]) for unit in ranked),
        sections=sections_of(store, unfit, uses, language),
        not_fit=sum(tally.units for tally in report.tallies if _is_not_fit(tally)),
        software=report.software,
    )


def _since(notice: DueDate, report: FleetReport) -> str:
    """``since 3 Mar 2026 (263 days)``."""
    due = notice.at
    return say("since {date} ({days})", date=day_of(due), days=counted((report.at - due).days, "day"))


def _standing_out(store: Store) -> tuple[PaperNotice, ...]:
    """The furthest out of their types, of those whose drift chance does not explain."""
    populations = Populations(store).most_evident(MOST_NOTICES)
    found = [(p, population) for population in populations for p in population.evident if abs(p.z) > STANDS_OUT]
    furthest = sorted(found, key=lambda pair: (-abs(pair[0].z), pair[0].serial, pair[0].sensor, pair[1].parameter))
    return tuple(PaperNotice(rate.serial, _drift(rate, population)) for rate, population in furthest[:MOST_NOTICES])


def _drift(placed: Placed, population: Population) -> str:
    """``A6 bias drifts +62 ± 4 µg a year``."""
    rate, sigma = placed.value * placed.tolerance, placed.sigma * placed.tolerance
    unit = deviation_measure(population.kind, population.parameter, abs(rate))
    write = measured if population.parameter == "axis" else signed
    parts = {"sensor": placed.sensor, "parameter": population.parameter, "rate": write(rate, COVERAGE * sigma, unit)}
    return say("{sensor} {parameter} drifts {rate} a year", **parts)


def _is_not_fit(tally: Tally) -> bool:
    return tally.verdict in NOT_FIT and condition_of(tally.verdict, is_reference=tally.is_reference) is not REFERENCE
