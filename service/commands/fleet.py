"""`imu-health fleet` and `history`: the condition of a running service's units, and their parameters through time."""

from datetime import datetime
from typing import Annotated

import typer
from rich.console import Group
from rich.markup import escape
from rich.table import Table

from estimator.allan.results import TERMS
from estimator.wording import counted
from service.client import Point, connect
from service.commands.calls import Answer
from service.commands.console import DEFAULT_SERVER, AsLines, FormOf, ListOutput, Server, table_of
from service.commands.speech import output_language, translated
from service.commands.upload import coloured
from service.kit.measures import deviation_measure, measured, number
from service.sessions.decision import Verdict
from service.sessions.records import ALL_PARAMETERS
from service.sessions.words.conditions import WITH_RESERVATION
from service.sessions.words.noise import size_in_words

KNOWN = (*ALL_PARAMETERS, *TERMS)
"""Parameters of a history."""
Stand = Annotated[str | None, typer.Option(help="Only those last measured on this stand.", show_default="all")]
UnitType = Annotated[str | None, typer.Option("--unit-type", help="Only those of this type.", show_default="all")]
DueBefore = Annotated[
    datetime | None, typer.Option(help="Only those whose next calibration is due before, UTC.", show_default="all")
]
Flagged = Annotated[bool, typer.Option("--flagged", help="Only those with an open flag.")]
Unit = Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")]
Sensor = Annotated[str | None, typer.Option(help="Only of this sensor.", show_default="all")]
Parameter = Annotated[str | None, typer.Option(help=f"Only one of {', '.join(KNOWN)}.", show_default="all")]
Since = Annotated[datetime | None, typer.Option(help="Measured at that time or later, UTC.", show_default="the first")]
Until = Annotated[datetime | None, typer.Option(help="Measured before that time, UTC.", show_default="the last")]


def fleet(
    server: Server = DEFAULT_SERVER,
    form: FormOf = None,
    as_json: AsLines = False,
    *,
    stand: Stand = None,
    unit_type: UnitType = None,
    due_before: DueBefore = None,
    flagged: Flagged = False,
) -> None:
    """Show every unit with its condition, the worst first; some of them by stand, type, due date or flag."""
    due = None if due_before is None else f"{due_before.isoformat()}Z"
    filters = {"stand": stand, "unit_type": unit_type, "due_before": due, "flagged": flagged or None}
    listing = ListOutput(form, as_json)
    with connect(server, language=listing.language) as client:
        condition = client.get("/fleet").json()
        units = [unit.document for unit in client.units(**filters)]
    is_complete = len(units) == condition["units"]
    part = translated("{shown} of {units}", shown=len(units), units=counted(condition["units"], "unit"))
    heading = _summary(condition) if is_complete else f"{part}\n"
    listing.show(units, lambda: Group(heading, _fleet_table(units)))


def _summary(condition: Answer) -> str:
    """``12 units, 12 of them simulated: 1 Unfit, …``"""
    counts = {Verdict(name): count for name, count in condition["verdicts"].items() if count}
    references = condition["references"]
    counts[Verdict.UNDECIDABLE] = counts.get(Verdict.UNDECIDABLE, 0) - references
    parts = [_counted(verdict, counts[verdict], condition) for verdict in reversed(Verdict) if counts.get(verdict)]
    parts += [f"{references} {coloured(Verdict.UNDECIDABLE, is_reference=True)}"] if references else []
    simulated = translated(", {n} of them simulated", n=condition["simulated"]) if condition["simulated"] else ""
    return f"{translated(counted(condition['units'], 'unit'))}{simulated}: {', '.join(parts)}\n"


def _counted(verdict: Verdict, count: int, condition: Answer) -> str:
    """``5 Fit (2 with reservation)``"""
    reserved = condition["reserved"][verdict]
    return f"{count} {coloured(verdict)}{f' ({reserved} {translated(WITH_RESERVATION)})' if reserved else ''}"


def _fleet_table(units: list[Answer]) -> Table:
    headings = ("unit", "type", "condition", "margin", "last session", "sessions", "why")
    table = table_of(*headings, right=("margin", "sessions"))
    for unit in units:
        table.add_row(
            escape(unit["serial"]) + (f" [dim]({translated('simulated')})[/]" if unit["simulated"] else ""),
            escape(unit["unit_type"]),
            coloured(unit["verdict"], unit["is_reference"], unit["said"]) if unit["verdict"] else "",
            translated(number(unit["margin"], 2)),
            (unit["last_at"] or "")[:10],
            str(unit["sessions"]),
            escape(unit["reason"]),
        )
    return table


def history(
    unit: Unit,
    sensor: Sensor = None,
    parameter: Parameter = None,
    since: Since = None,
    until: Until = None,
    *,
    server: Server = DEFAULT_SERVER,
    form: FormOf = None,
    as_json: AsLines = False,
) -> None:
    """Show the parameters of a unit through time, each beside its reference and its tolerance.

    The terms of noise at rest, of sessions that were sent as raw logs, stand beside them: their size and where it lies
    with 95 %.
    """
    with connect(server, language=output_language()) as client:
        points = list(client.history(unit, sensor=sensor, parameter=parameter, since=since, until=until))
    ListOutput(form, as_json).show([point.document for point in points], lambda: _history_table(points))


def _history_table(points: list[Point]) -> Table:
    table = table_of(
        "measured",
        "sensor",
        "parameter",
        "off reference",
        "tolerance",
        "condition",
        right=("off reference", "tolerance"),
    )
    for point in points:
        condition = "" if point.parameter in TERMS else coloured(point.verdict, point.is_reference)
        day, sensor = f"{point.at:%Y-%m-%d}", escape(point.sensor)
        table.add_row(day, sensor, translated(point.parameter), *map(translated, _numbers(point)), condition)
    return table


def _numbers(point: Point) -> tuple[str, str]:
    """The deviation ± U and the tolerance, in one measure; a reference has no deviation."""
    if point.parameter in TERMS:
        return size_in_words(point.kind, point.parameter, point.value, point.u), ""
    tolerance = point.tolerance
    if tolerance is not None and point.parameter == "scale":
        tolerance = tolerance / abs(point.reference) if point.reference else None
    unit = deviation_measure(point.kind, point.parameter, point.deviation or 0.0)
    off = "" if point.deviation is None else measured(point.deviation, point.expanded, unit)
    return off, "" if tolerance is None else measured(tolerance, None, unit)
