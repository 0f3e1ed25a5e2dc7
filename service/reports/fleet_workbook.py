"""The fleet as a workbook: its condition, the parameters of every unit, their histories, and what the numbers mean."""

import io
from collections.abc import Iterator

from service.languages.language import Language
from service.measures import MEASURES, Measure, in_measure, value_measure
from service.records.decision import Decision
from service.records.history import HistoryPoint
from service.records.outlook import UnitOutlook
from service.records.unit import UnitSummary
from service.reports.sheets import Cell, Column, Kind, Workbook
from service.storage.store import Store
from service.views.fleet_report import FleetReport
from service.words.conditions import condition_of, said_with
from service.words.verdict import unit_in_words

MOST_HISTORY_ROWS = 30_000
"""Rows of the sheet of histories; the newest sessions of every unit share them alike."""

FLEET = (
    Column("Unit", width=16), Column("Type", width=22), Column("Condition", Kind.VERDICT, 24),
    Column("Worst sensor"), Column("Worst parameter"),
    Column("Tolerance used, with U", Kind.SHARE, 12), Column("Margin to tolerance", Kind.SHARE, 12),
    Column("Last session, UTC", Kind.TIME, 17), Column("Next calibration due", Kind.DATE, 13),
    Column("Overdue", width=9),
    Column("Sessions", Kind.NUMBER, 9), Column("Open flags", Kind.NUMBER, 9), Column("Simulated", width=10),
    Column("Why", width=60), Column("Why due then", width=50), Column("What the simulation gets wrong", width=60),
    Column("Session", width=23), Column("Verdict in words", width=60),
)  # fmt: skip
PARAMETERS = (
    Column("Unit", width=16), Column("Session", width=23), Column("Sensor", width=9), Column("Kind"),
    Column("Parameter", width=13), Column("Value", Kind.NUMBER), Column("Reference", Kind.NUMBER),
    Column("Unit of value", width=12), Column("Deviation", Kind.CHANGE), Column("U of deviation", Kind.CHANGE),
    Column("k", Kind.NUMBER, 5), Column("Tolerance", Kind.CHANGE), Column("Unit of deviation", width=12),
    Column("Probability out of tolerance", Kind.CHANCE), Column("Margin to tolerance", Kind.SHARE, 12),
    Column("Verdict", Kind.VERDICT, 15), Column("Rule", width=34),
)  # fmt: skip
HISTORIES = (
    Column("Unit", width=16), Column("Measured, UTC", Kind.TIME, 17), Column("Sensor", width=9), Column("Kind"),
    Column("Parameter", width=13), Column("Value", Kind.NUMBER), Column("Lower, −U", Kind.NUMBER),
    Column("Upper, +U", Kind.NUMBER), Column("Unit of value", width=12), Column("Deviation", Kind.CHANGE),
    Column("U of deviation", Kind.CHANGE), Column("Unit of deviation", width=12), Column("Verdict", Kind.VERDICT, 15),
    Column("Model revision", Kind.NUMBER, 9), Column("Session", width=23),
)  # fmt: skip
ABOUT = (Column("What", width=26), Column("Value", width=110))
"""The columns of the four sheets; widths in characters, for the longest usual text."""


def fleet_xlsx(store: Store, report: FleetReport, language: Language = Language.ENGLISH) -> bytes:
    """The workbook; its rows are read and written one after another."""
    target = io.BytesIO()
    sessions = _sessions_shown(store)
    outlooks = {outlook.serial: outlook for outlook in report.outlooks}
    book = Workbook(target, report.at, "Fleet report", language)
    book.table("Fleet", FLEET, (_fleet_row(unit, outlooks.get(unit.serial)) for unit in report.units))
    book.table("Parameters", PARAMETERS, (_parameter_row(*row) for row in store.fleet_rows.latest_decisions()))
    book.table("Histories", HISTORIES, (_history_row(*row) for row in store.fleet_rows.histories(sessions)))
    book.table("About", ABOUT, _about(report, sessions))
    book.close()
    return target.getvalue()


def _sessions_shown(store: Store) -> int:
    """Sessions of every unit that the histories have room for."""
    return max(1, MOST_HISTORY_ROWS // max(1, store.fleet_rows.points_of_latest()))


def _fleet_row(unit: UnitSummary, outlook: UnitOutlook | None) -> tuple[Cell, ...]:
    condition = condition_of(unit.verdict, is_reference=unit.is_reference)
    word = said_with(condition, unit.reservations).word
    return (
        unit.serial, unit.unit_type, word, unit.worst_sensor, unit.worst_parameter,
        None if unit.margin is None else 1 - unit.margin, unit.margin, unit.last_at,
        None if outlook is None else outlook.due, None if outlook is None else outlook.overdue,
        unit.sessions, unit.flags, unit.simulated,
        unit.reason, None if outlook is None else outlook.reason, unit.diagnosis, unit.last_session,
        unit_in_words(unit),
    )  # fmt: skip


def _parameter_row(serial: str, session: str, decision: Decision) -> tuple[Cell, ...]:
    value, deviation = _units(decision.kind, decision.parameter)
    return (
        serial, session, decision.sensor, decision.kind, decision.parameter, in_measure(decision.value, value),
        in_measure(decision.reference, value), value.label, in_measure(decision.deviation, deviation),
        in_measure(decision.expanded, deviation), decision.coverage_factor, in_measure(decision.tolerance, deviation),
        deviation.label, decision.probability_out, decision.margin, condition_of(decision.verdict).formal,
        decision.rule,
    )  # fmt: skip


def _history_row(serial: str, point: HistoryPoint) -> tuple[Cell, ...]:
    value, deviation = _units(point.kind, point.parameter)
    return (
        serial, point.at, point.sensor, point.kind, point.parameter, in_measure(point.value, value),
        in_measure(point.lower, value), in_measure(point.upper, value), value.label,
        in_measure(point.deviation, deviation), in_measure(point.expanded, deviation), deviation.label,
        condition_of(point.verdict, is_reference=point.is_reference).formal, point.revision, point.session,
    )  # fmt: skip


def _units(kind: str, parameter: str) -> tuple[Measure, Measure]:
    """Of a value and of its change; the same in every row of a parameter, so that columns can be compared."""
    return value_measure(kind, parameter, 0.0), MEASURES[kind, parameter]


def _about(report: FleetReport, sessions: int) -> Iterator[tuple[Cell, ...]]:
    yield "Made", f"{report.at:%Y-%m-%d %H:%M} UTC by imu-health {report.software}"
    yield "Units", f"{report.condition.units}, of them {report.condition.simulated} simulated"
    yield "Sheet Parameters", "The latest session of every unit: each parameter against its reference."
    yield "Sheet Histories", f"The newest sessions of every unit, at most {sessions} of each."
    yield "U", "Expanded uncertainty, k times the standard one."
    yield "Deviation", "From the unit's reference session, without what all sensors did together."
    yield "Tolerance used, with U", "(|deviation| + U) / tolerance of the parameter closest to its tolerance."
    yield "Scale factors", "Reading units per g, or per degree a second; their changes in ppm."
    yield "Input axis", "The angle from the axis of the reference."
