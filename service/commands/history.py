"""`imu-health history`: the parameters of a unit through time."""

from datetime import datetime
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from estimator.allan.results import TERMS
from service.client import Point, connect
from service.commands.console import DEFAULT_SERVER, Server
from service.commands.listing import AsLines, FormOf, Listing, table_of
from service.commands.upload import coloured
from service.kit.measures import deviation_measure, measured
from service.sessions.records import ALL_PARAMETERS
from service.sessions.words.noise import size_in_words

KNOWN = (*ALL_PARAMETERS, *TERMS)
Unit = Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")]
Sensor = Annotated[str | None, typer.Option(help="Only of this sensor.", show_default="all")]
Parameter = Annotated[str | None, typer.Option(help=f"Only one of {', '.join(KNOWN)}.", show_default="all")]
Since = Annotated[datetime | None, typer.Option(help="Measured at that time or later, UTC.", show_default="the first")]
Until = Annotated[datetime | None, typer.Option(help="Measured before that time, UTC.", show_default="the last")]


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
    with connect(server) as client:
        found = list(client.history(unit, sensor=sensor, parameter=parameter, since=since, until=until))
    Listing(form, as_json).show([point.document for point in found], lambda: _table(found))


def _table(found: list[Point]) -> Table:
    table = table_of(
        "measured",
        "sensor",
        "parameter",
        "off reference",
        "tolerance",
        "condition",
        right=("off reference", "tolerance"),
    )
    for point in found:
        condition = "" if point.parameter in TERMS else coloured(point.verdict, point.is_reference)
        day, sensor = f"{point.at:%Y-%m-%d}", escape(point.sensor)
        table.add_row(day, sensor, point.parameter, *_numbers(point), condition)
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
