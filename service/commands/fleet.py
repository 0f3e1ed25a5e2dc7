"""`imu-health fleet`, `history`, `usable` and `flags`: the condition of a running service's units."""

from datetime import datetime
from itertools import takewhile
from typing import TYPE_CHECKING, Annotated
from urllib.parse import quote

import typer
from rich.console import Group
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from estimator.allan.results import TERMS
from estimator.json_object import Json
from estimator.on_demand import function_on_demand
from estimator.wording import counted
from service.client import Point, connect
from service.commands.console import DEFAULT_SERVER, AsJson, AsLines, ListOutput, Server, print_json, screen, table_of
from service.commands.speech import FAILED, output_language, translated
from service.commands.upload import coloured
from service.flags.records import FlagState
from service.fleet.use import Use
from service.kit.measures import deviation_measure, measured, number
from service.languages.language import Language
from service.sessions.decision import Verdict
from service.sessions.records import ALL_PARAMETERS
from service.sessions.words.conditions import WITH_RESERVATION
from service.sessions.words.noise import size_in_words

if TYPE_CHECKING:
    from service.groups.words import place_in_words
else:
    place_in_words = function_on_demand("service.groups.words", "place_in_words")

KNOWN = (*ALL_PARAMETERS, *TERMS)
"""Parameters of a history."""
FLAG_COLOURS = {FlagState.RAISED: "red", FlagState.ACKNOWLEDGED: "yellow", FlagState.RESOLVED: "green"}
"""Red needs attention."""
USE_COLOURS = {Use.YES: "green", Use.RESERVED: "yellow", Use.NO: "bold red", Use.PENDING: "bold red"}
Stand = Annotated[str | None, typer.Option(help="Only those last measured on this stand.", show_default="all")]
DueBefore = Annotated[
    datetime | None, typer.Option(help="Only those whose next calibration is due before, UTC.", show_default="all")
]
Unit = Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")]
Sensor = Annotated[str | None, typer.Option(help="Only of this sensor.", show_default="all")]
Parameter = Annotated[str | None, typer.Option(help=f"Only one of {', '.join(KNOWN)}.", show_default="all")]
Since = Annotated[datetime | None, typer.Option(help="Measured at that time or later, UTC.", show_default="the first")]


def fleet(
    server: Server = DEFAULT_SERVER, as_json: AsLines = None, stand: Stand = None, due_before: DueBefore = None
) -> None:
    """Show every unit with its condition, the worst first; some of them by stand or due date."""
    due = None if due_before is None else f"{due_before.isoformat()}Z"
    filters = {"stand": stand, "due_before": due}
    listing = ListOutput.of(as_json)
    with connect(server, language=listing.language) as client:
        condition = client.get("/fleet").json()
        units = [unit.document for unit in client.units(**filters)]
    is_complete = len(units) == condition["units"]
    part = translated("{shown} of {units}", shown=len(units), units=counted(condition["units"], "unit"))
    heading = _summary(condition) if is_complete else f"{part}\n"
    listing.show(units, lambda: Group(heading, _fleet_table(units)))


def _summary(condition: Json) -> str:
    """``12 units, 12 of them simulated: 1 Unfit, …``"""
    counts = {Verdict(name): count for name, count in condition["verdicts"].items() if count}
    references = condition["references"]
    counts[Verdict.UNDECIDABLE] = counts.get(Verdict.UNDECIDABLE, 0) - references
    parts = [_counted(verdict, counts[verdict], condition) for verdict in reversed(Verdict) if counts.get(verdict)]
    parts += [f"{references} {coloured(Verdict.UNDECIDABLE, is_reference=True)}"] if references else []
    simulated = translated(", {n} of them simulated", n=condition["simulated"]) if condition["simulated"] else ""
    return f"{translated(counted(condition['units'], 'unit'))}{simulated}: {', '.join(parts)}\n"


def _counted(verdict: Verdict, count: int, condition: Json) -> str:
    """``5 Fit (2 with reservation)``"""
    reserved = condition["reserved"][verdict]
    return f"{count} {coloured(verdict)}{f' ({reserved} {translated(WITH_RESERVATION)})' if reserved else ''}"


def _fleet_table(units: list[Json]) -> Table:
    headings = ("unit", "use", "type", "condition", "margin", "last session", "sessions", "why")
    table = table_of(*headings, right=("margin", "sessions"))
    for unit in units:
        table.add_row(
            escape(unit["serial"]) + (f" [dim]({translated('simulated')})[/]" if unit["simulated"] else ""),
            _use_of(unit),
            escape(unit["unit_type"]),
            coloured(unit["verdict"], unit["is_reference"], unit["said"]) if unit["verdict"] else "",
            translated(number(unit["margin"], 2)),
            (unit["last_at"] or "")[:10],
            str(unit["sessions"]),
            escape(unit["reason"]),
        )
    return table


def _use_of(unit: Json) -> str:
    colour = USE_COLOURS[Use.YES if unit["usable"] else Use.NO]
    return f"[{colour}]{escape(translated(unit['use']))}[/]"


def history(
    unit: Unit,
    sensor: Sensor = None,
    parameter: Parameter = None,
    since: Since = None,
    *,
    server: Server = DEFAULT_SERVER,
    as_json: AsLines = None,
) -> None:
    """Show the parameters of a unit through time, each beside its reference and its tolerance.

    The terms of noise at rest, of sessions that were sent as raw logs, stand beside them: their size and where it lies
    with 95 %.
    """
    with connect(server, language=output_language()) as client:
        points = list(client.history(unit, sensor=sensor, parameter=parameter, since=since))
    ListOutput.of(as_json).show([point.document for point in points], lambda: _history_table(points))


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


def usable(unit: Unit, server: Server = DEFAULT_SERVER, as_json: AsJson = False) -> None:
    """Say whether a unit may be used: exit code 0 for yes, 1 for no, for a unit nobody knows, and in doubt."""
    language = Language.ENGLISH.value if as_json else output_language()
    with connect(server, language=language) as client:
        answer: Json = client.get(f"/units/{quote(unit, safe='')}/usable").json()
    print_json(answer) if as_json else _show_usable(unit, answer)
    if not answer["usable"]:
        raise typer.Exit(FAILED)


def _show_usable(unit: str, answer: Json) -> None:
    use = Use(answer["answer"])
    reservations = (f"{translated('But')}: {line}" for line in answer["reservations"])
    lines = (answer["why"], *answer["reasons"][1:], *reservations)
    word = escape(translated(answer["use"]))
    head = f"[bold]{escape(unit)}[/]  [{USE_COLOURS[use]}]{word}[/]"
    screen().print(head, *(escape(translated(line)) for line in lines), sep="\n  ")


def flags(
    unit: Annotated[str | None, typer.Option(help="Only of this serial number.")] = None,
    state: Annotated[FlagState | None, typer.Option(help="Only in this state.", show_default="open ones")] = None,
    assigned: Annotated[
        str | None, typer.Option(help="Only of this login or name; `me`: of the token's account; `nobody`.")
    ] = None,
    server: Server = DEFAULT_SERVER,
    as_json: AsLines = None,
) -> None:
    """Show flags; without a state those that are open."""
    filters, listing = {"unit": unit, "state": state, "assigned": assigned}, ListOutput.of(as_json)
    with connect(server, language=listing.language) as client:
        found = client.every("/flags", "flags", limit=1000, **filters)
        rows = list(found if state else takewhile(lambda flag: flag["state"] != FlagState.RESOLVED, found))
    nothing = "There is none." if state else "No flag is open."
    listing.show(rows, lambda: _flag_table(rows) if rows else Text(translated(nothing)))


def _flag_table(flags: list[Json]) -> Table:
    table = table_of("flag", "unit", "state", "since", "who", "where", "what", right=("flag",))
    for flag in flags:
        state = FlagState(flag["state"])
        table.add_row(
            str(flag["id"]),
            escape(flag["unit"]),
            f"[{FLAG_COLOURS[state]}]{translated(state.value)}[/]",
            flag["raised_at"][:10],
            escape(flag["assignee"]),
            escape(translated(place_in_words(flag["place"], flag["subject"] or flag["unit"]))),
            escape(translated(f"{flag['summary']} {flag['proposal']}".strip())),
        )
    return table
