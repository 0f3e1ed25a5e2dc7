"""The fleet as a workbook: its condition, the parameters of every unit, their histories, and what the numbers mean."""

import io
from collections.abc import Iterator

from estimator.message import say
from service.fleet.condition import UnitSummary
from service.fleet.records import FleetQuery
from service.fleet.rows_store import FleetRows
from service.fleet.store import Fleet
from service.judging.records import Usable
from service.judging.usable_reading import usable_of
from service.judging.words import unit_in_words
from service.kit.measures import MEASURES, Measure, in_measure, value_measure
from service.languages.language import Language
from service.papers.fleet.report import MOST_UNITS, FleetReport
from service.papers.sheets import Cell, CellKind, Column, Workbook
from service.sessions.decision import Decision
from service.sessions.records import HistoryPoint
from service.sessions.words.conditions import condition_of, said_with
from service.storage.queries import Store

MOST_HISTORY_ROWS = 30_000
"""Rows of the sheet of histories; the newest sessions of every unit share them alike."""
MOST_DETAILED = 1000
"""Units whose parameters and histories have rows, the worst: more than anybody reads, and so the workbook of a large
fleet is made in seconds. The tables of the API have all."""

UNIT, SESSION = Column("Unit", width=16, is_named=True), Column("Session", width=23, is_named=True)
SENSOR = Column("Sensor", width=9, is_named=True)
FLEET = (
    UNIT, Column("Type", width=22, is_named=True), Column("Condition", CellKind.VERDICT, 24),
    Column("Worst sensor", is_named=True), Column("Worst parameter"),
    Column("Tolerance used, with U", CellKind.SHARE, 12), Column("Margin to tolerance", CellKind.SHARE, 12),
    Column("Last session, UTC", CellKind.TIME, 17), Column("Next calibration due", CellKind.DATE, 13),
    Column("Overdue", width=9),
    Column("Sessions", CellKind.NUMBER, 9), Column("Open flags", CellKind.NUMBER, 9), Column("Simulated", width=10),
    Column("Why", width=60), Column("Why due then", width=50), Column("Diagnosis", width=60),
    SESSION, Column("Verdict in words", width=60), Column("May it be used", width=40),
)  # fmt: skip
PARAMETERS = (
    UNIT, SESSION, SENSOR, Column("Kind"),
    Column("Parameter", width=13), Column("Value", CellKind.NUMBER), Column("Reference", CellKind.NUMBER),
    Column("Unit of value", width=12), Column("Deviation", CellKind.CHANGE), Column("U of deviation", CellKind.CHANGE),
    Column("k", CellKind.NUMBER, 5), Column("Tolerance", CellKind.CHANGE), Column("Unit of deviation", width=12),
    Column("Probability out of tolerance", CellKind.CHANCE), Column("Margin to tolerance", CellKind.SHARE, 12),
    Column("Verdict", CellKind.VERDICT, 15), Column("Rule", width=34),
)  # fmt: skip
HISTORIES = (
    UNIT, Column("Measured, UTC", CellKind.TIME, 17), SENSOR, Column("Kind"),
    Column("Parameter", width=13), Column("Value", CellKind.NUMBER), Column("Lower, −U", CellKind.NUMBER),
    Column("Upper, +U", CellKind.NUMBER), Column("Unit of value", width=12), Column("Deviation", CellKind.CHANGE),
    Column("U of deviation", CellKind.CHANGE), Column("Unit of deviation", width=12),
    Column("Verdict", CellKind.VERDICT, 15),
    Column("Model revision", CellKind.NUMBER, 9), SESSION,
)  # fmt: skip
ABOUT = (Column("What", width=26), Column("Value", width=110))
"""The columns of the four sheets; widths in characters, for the longest usual text."""


def fleet_xlsx(store: Store, report: FleetReport, language: Language = Language.ENGLISH) -> bytes:
    """The workbook; its rows are read and written one after another."""
    target = io.BytesIO()
    units = Fleet(store).units(FleetQuery(limit=MOST_UNITS))
    serials = tuple(unit.serial for unit in units[:MOST_DETAILED])
    sessions = max(1, MOST_HISTORY_ROWS // max(1, FleetRows(store).points_of_latest(serials)))
    book = Workbook(target, report.at, "Fleet report", language)
    uses = usable_of(store, units, report.at)
    book.table("Fleet", FLEET, (_fleet_row(unit, uses[unit.serial]) for unit in units))
    book.table("Parameters", PARAMETERS, (_parameter_row(*row) for row in FleetRows(store).latest_decisions(serials)))
    book.table("Histories", HISTORIES, (_history_row(*row) for row in FleetRows(store).histories(serials, sessions)))
    book.table("About", ABOUT, _about(report, sessions, len(serials) if len(units) > len(serials) else None))
    book.close()
    return target.getvalue()


def _fleet_row(unit: UnitSummary, usable: Usable) -> tuple[Cell, ...]:
    condition = condition_of(unit.verdict, is_reference=unit.is_reference)
    word, used = said_with(condition, unit.reservations).word, unit.used
    return (
        unit.serial, unit.unit_type, word, unit.worst_sensor, unit.worst_parameter,
        None if used is None else used.deviation + used.expanded, None if used is None else unit.margin, unit.last_at,
        usable.due, usable.is_overdue,
        unit.sessions, unit.flags, unit.simulated,
        unit.reason, unit.due_reason or None, unit.diagnosis, unit.last_session,
        unit_in_words(unit), usable.use,
    )  # fmt: skip


def _parameter_row(serial: str, session: str, decision: Decision) -> tuple[Cell, ...]:
    value, deviation = _units(decision.kind, decision.parameter)
    return (
        serial, session, decision.sensor, decision.kind, decision.parameter, in_measure(decision.value, value),
        in_measure(decision.reference, value), value.label, in_measure(decision.deviation, deviation),
        in_measure(decision.expanded, deviation), decision.coverage_factor, in_measure(decision.tolerance, deviation),
        deviation.label, decision.probability_out, decision.margin, condition_of(decision.verdict).word,
        decision.rule,
    )  # fmt: skip


def _history_row(serial: str, point: HistoryPoint) -> tuple[Cell, ...]:
    value, deviation = _units(point.kind, point.parameter)
    return (
        serial, point.at, point.sensor, point.kind, point.parameter, in_measure(point.value, value),
        in_measure(point.lower, value), in_measure(point.upper, value), value.label,
        in_measure(point.deviation, deviation), in_measure(point.expanded, deviation), deviation.label,
        condition_of(point.verdict, is_reference=point.is_reference).word, point.revision, point.session,
    )  # fmt: skip


def _units(kind: str, parameter: str) -> tuple[Measure, Measure]:
    """Measures of a value and of its change; equal in every row of a parameter, so that columns can be compared."""
    return value_measure(kind, parameter, 0.0), MEASURES[kind, parameter]


def _about(report: FleetReport, sessions: int, only: int | None) -> Iterator[tuple[Cell, ...]]:
    yield (
        "Made",
        say("{time} UTC by imu-health {software}", time=f"{report.at:%Y-%m-%d %H:%M}", software=report.software),
    )
    yield (
        "Units",
        say(
            "{units}, of them {simulated} simulated", units=report.condition.units, simulated=report.condition.simulated
        ),
    )
    if only is None:
        yield "Sheet Parameters", "The latest session of every unit: each parameter against its reference."
        yield (
            "Sheet Histories",
            say("The newest sessions of every unit, at most {sessions} of each.", sessions=sessions),
        )
    else:
        yield (
            "Sheet Parameters",
            say("The latest session of each of the {number} units at the top of the sheet Fleet.", number=only),
        )
        yield (
            "Sheet Histories",
            say(
                "The newest sessions of these {number} units, at most {sessions} of each.",
                number=only,
                sessions=sessions,
            ),
        )
    yield "U", "Expanded uncertainty, k times the standard one."
    yield "Deviation", "From the unit's reference session, without what all sensors did together."
    yield "Tolerance used, with U", "(|deviation| + U) / tolerance of the parameter closest to its tolerance."
    yield "Scale factors", "Reading units per g, or per degree a second; their changes in ppm."
    yield "Input axis", "The angle from the axis of the reference."
