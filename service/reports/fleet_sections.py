"""A unit in the fleet's report: its line in the ranking, and its section where it is not fit."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from service.charts.history import history_charts
from service.charts.tracks import tracks_of
from service.measures import number
from service.records.decision import Decision, Verdict
from service.records.event import Service
from service.records.history import HistoryPoint
from service.records.unit import UnitSummary
from service.reports.moved import Moved, moved
from service.reports.pictures import picture
from service.storage.store import Store
from service.words.conditions import Condition, condition_of
from service.words.names import day_of
from service.words.verdict import but

MOST_MOVED = 8
"""Parameters of one unit that are listed."""
WIDTH = 330
"""Of a drawn history, pixels: half of the page."""
T = TypeVar("T")


@dataclass(frozen=True)
class Line:
    """One unit in the ranking."""

    unit: str
    unit_type: str
    condition: Condition
    but: str
    """What the verdict is said with; empty where it is plain."""
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


def line_of(unit: UnitSummary) -> Line:
    """How the unit stands, in people's units."""
    return Line(
        unit=unit.serial,
        unit_type=unit.unit_type,
        condition=condition_of(unit.verdict, is_reference=unit.is_reference),
        but=but(unit.reservations),
        worst=f"{unit.worst_sensor or ''} {unit.worst_parameter or ''}".strip(),
        used="" if unit.margin is None else f"{number(100 * (1 - unit.margin), 0)} %",
        last="" if unit.last_at is None else day_of(unit.last_at),
        simulated=unit.simulated,
    )


def sections_of(store: Store, units: Sequence[UnitSummary]) -> tuple[Section, ...]:
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
    line, wrong = line_of(unit), _worst_first(decisions)
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
    return picture(charts, charts.panels[0], WIDTH)
