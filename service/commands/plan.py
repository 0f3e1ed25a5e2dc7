"""`imu-health plan`: expected results of a session before it is measured."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from estimator.calibration.free.schedule import GENERIC
from estimator.diagnosis.residuals.orientations import fitted_state
from estimator.errors import Problem, SessionError
from estimator.planning import OrientationRank, Plan, plan, proposed_orientations, rank_of_orientations
from estimator.planning.expected import head_kind, input_noise
from estimator.reading.bounds import WITHIN
from estimator.results import Calibration
from estimator.session import ARBITRARY_ORIENTATIONS, Array, CalibrationSession
from estimator.simulate import orientation_schedule
from estimator.thermal.plan import expected
from estimator.thermal.simulate import thermal_schedule
from service.commands.calibrate import temperature_view
from service.commands.console import AsJson, print_json, screen, usable
from service.commands.options import checked
from service.ingest import read_file
from service.kit.measures import number
from service.planning.question import PlanQuestion
from service.planning.words import (
    UNSEEN,
    blind,
    headline,
    seen,
    sigma_in_words,
    tolerance_in_words,
    unobserved,
)

PARAMETERS = ("scale", "bias", "quadratic", "axis")
"""Parameters in the order of the table."""
MOST_ORIENTATIONS = 200
"""Most orientations of a plan: nobody turns a block by hand more often."""


def plan_session(
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="SESSION", help="Session whose block, stand and noise to plan with.", show_default=False
        ),
    ] = None,
    *,
    kind: Annotated[str, typer.Option(help="Without SESSION: accelerometer or gyroscope.")] = "accelerometer",
    sensors: Annotated[int, typer.Option("--sensors", "-m", help="Without SESSION: sensors on a cone.")] = 6,
    alpha: Annotated[
        float | None, typer.Option(help="Elevation of the head, degrees.", show_default="proposed")
    ] = None,
    positions: Annotated[
        int | None, typer.Option("--positions", "-n", help="Positions a run.", show_default="proposed")
    ] = None,
    runs: Annotated[str, typer.Option(help="both or direct.")] = "both",
    tolerance: Annotated[
        list[str] | None,
        typer.Option(
            help="PARAMETER=AMOUNT: scale in ppm, bias in µg (°/h), quadratic in µg/g², axis in arcsec. Repeatable.",
            show_default=False,
        ),
    ] = None,
    orientations: Annotated[
        int | None, typer.Option(help="Propose this many still orientations instead of a stand.", show_default=False)
    ] = None,
    temperatures: Annotated[
        str | None, typer.Option(help="Soaks of a thermal session in order, °C: 20,-40,70,20.", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Plan a session: elevation, positions, expected uncertainty of every parameter, and what it cannot see.

    A SESSION in arbitrary orientations is answered with the rank of its orientations and what to add. --temperatures
    is answered with the bands of bias and scale factor over temperature, the orientations repeated at every soak.
    """
    question = checked(
        PlanQuestion, kind=kind, sensors=sensors, elevation=alpha, positions=positions, runs=runs,
        **dict(map(amount, tolerance or ())),
    )  # fmt: skip
    with usable(file or Path("plan")):
        pattern = question.cone() if file is None else read_file(file)
        if temperatures is not None:
            sigma = question.sigma(pattern) if file is None else input_noise(pattern)
            _show(over_temperature(pattern, soaks(temperatures), orientations or GENERIC, sigma), as_json)
        elif orientations is not None or pattern.programme == ARBITRARY_ORIENTATIONS:
            _show(rank_of(pattern, orientations), as_json)
        else:
            sigma = question.sigma(pattern) if file is None else input_noise(pattern)
            _show(plan(pattern, question.request(head_kind(pattern)), sigma=sigma), as_json)


def soaks(text: str) -> tuple[float, ...]:
    """``20,-40,70`` as temperatures, °C; a usage error when it is not of that form."""
    try:
        found = tuple(float(part) for part in text.split(","))
    except ValueError:
        found = ()
    if not found or any(temperature not in WITHIN["temperature_c"] for temperature in found):
        raise typer.BadParameter(f"--temperatures {text!r}: write soaks in °C, for instance 20,-40,70,20")
    return found


def over_temperature(
    pattern: CalibrationSession, temperatures: tuple[float, ...], orientations: int, sigma: Array
) -> Calibration:
    """Expected results of a thermal session of the block; ``sigma`` (m,) of a reading at the input, m/s² (rad/s)."""
    if not 1 <= orientations <= MOST_ORIENTATIONS:
        raise SessionError([Problem("--orientations", f"ask for 1 to {MOST_ORIENTATIONS}")])
    sensors = tuple(replace(sensor, bias_repeatability=0.0) for sensor in pattern.sensors)  # sigma holds it
    up = proposed_orientations(sensors, orientations)
    schedule = orientation_schedule(sensors, pattern.site, up, unit_name=pattern.unit)
    noise = sigma * np.abs([sensor.nominal_scale for sensor in sensors])
    return expected(thermal_schedule(schedule, np.random.default_rng(0), temperatures), noise)


def _show(result: Plan | OrientationRank | Calibration, as_json: bool) -> None:
    if as_json:
        print_json(result.to_dict())
    elif isinstance(result, Calibration):
        screen().print(Group(*temperature_view(result)))
    else:
        screen().print(plan_view(result) if isinstance(result, Plan) else orientation_view(result))


def amount(text: str) -> tuple[str, str]:
    """``bias=50`` as a name and a number still to be checked."""
    name, equals, value = text.partition("=")
    if not equals or name not in PARAMETERS:
        raise typer.BadParameter(f"{text!r}: write PARAMETER=AMOUNT, for instance bias=50; {', '.join(PARAMETERS)}")
    return name, value


def rank_of(session: CalibrationSession, number: int | None) -> OrientationRank:
    """Rank of the session's own orientations, or of a requested number."""
    if number is None:
        return rank_of_orientations(session.sensors, directions_of(session))
    if not 1 <= number <= MOST_ORIENTATIONS:
        raise SessionError([Problem("--orientations", f"ask for 1 to {MOST_ORIENTATIONS}")])
    return rank_of_orientations(session.sensors, proposed_orientations(session.sensors, number))


def directions_of(session: CalibrationSession) -> Array:
    """(R, 3) directions, dimensionless, as stated in the session, else as shown by its readings."""
    if session.directions is None or not np.isfinite(session.directions).all():
        return fitted_state(session).directions
    return session.directions


def plan_view(found: Plan) -> RenderableType:
    """The plan as text and tables."""
    coverage = number(found.request.coverage)
    heading = Text(headline(found), "bold")
    facts = Text(
        f"Head at {number(float(np.degrees(found.elevation)), 1)}° "
        f"(formula for the stand alone: {number(float(np.degrees(found.formula_elevation)), 1)}°); "
        f"equal steps are {number(100 * found.optimal.efficiency, 1)} % as good as the best positions."
    )
    limits = (
        _limits(found) if found.limits else Text("Too many readings to look for every cause in; plan fewer.", "yellow")
    )
    return Group(heading, facts, Text(""), _parameters(found, coverage), Text(""), limits, *_blind(found))


def _parameters(found: Plan, coverage: str) -> Table:
    table = Table(box=None, pad_edge=False, title=f"Expected, U with k = {coverage}", title_justify="left")
    for heading in ("sensor", *PARAMETERS):
        table.add_column(heading)
    rows = [found.judged[i : i + len(PARAMETERS)] for i in range(0, len(found.judged), len(PARAMETERS))]
    for row in rows:
        cells = []
        for judged in row:
            verdict = "" if judged.verdict == "not judged" else f"{tolerance_in_words(judged)}, {judged.verdict}"
            cells.append(f"{sigma_in_words(judged, found.request.coverage)} {verdict}".strip())
        table.add_row(row[0].sensor, *cells)
    return table


def _limits(found: Plan) -> Table:
    table = Table(box=None, pad_edge=False, title="Smallest effect that would be detected", title_justify="left")
    table.add_column("cause")
    table.add_column("size")
    for line in seen(found):
        table.add_row(line.cause, line.size)
    return table


def _blind(found: Plan) -> list[Text]:
    lines = [Text(f"Cannot see {line.causes}: {line.reason}.", "yellow") for line in blind(found)]
    if missing := unobserved(found):
        lines.append(Text(f"{UNSEEN.capitalize()}: {missing}.", "yellow"))
    return lines


def orientation_view(found: OrientationRank) -> RenderableType:
    """The rank as text and a table."""
    result = "identify everything" if found.full else "leave something open"
    lines = [
        Text(f"{len(found.directions)} orientations {result}: rank {found.rank} of {found.parameters}.", "bold"),
        Text(f"Least known: {found.weakest[0]}."),
        *(Text(f"Open: {direction}", "yellow") for direction in found.unseen),
    ]
    table = Table(box=None, pad_edge=False, title="Direction of up, block axes", title_justify="left")
    for heading in ("", "x", "y", "z"):
        table.add_column(heading)
    for name, directions in (("planned", found.directions), ("add", found.add)):
        for direction in directions:
            table.add_row(name, *(number(float(x), 3) for x in direction))
    return Group(*lines, Text(""), table)
