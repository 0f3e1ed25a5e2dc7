"""`imu-health parity`: a recording of any length against the calibration that corrects its readings."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from estimator import calibrate
from estimator.message import joined
from estimator.parity import ParityAccumulator, ParityResult
from estimator.parity.as_calibration import before_faults
from estimator.parity.results import Sight
from service.commands.console import AsJson, print_json, screen, usable
from service.ingest.stream import open_recording, session_in
from service.judging.fault_words import faults_in_words, said_of
from service.judging.parity_words import parts_in_words
from service.judging.temperature_words import far_from_reference
from service.judging.words import found_in_words
from service.kit.measures import COVERAGE, in_words

PARAMETERS = ("bias", "scale", "axis")
"""Parameters visible in a recording in service, the most frequent change first."""

File = Annotated[Path, typer.Argument(metavar="FILE", help="The recording.", show_default=False)]
Reference = Annotated[Path, typer.Option(help="Session file of the calibration to compare with.", show_default=False)]
Motion = Annotated[str, typer.Option(help="`still`, `any`, or `auto`: motion is left out where it spoils parity.")]


def parity(file: File, reference: Reference, motion: Motion = "auto", as_json: AsJson = False) -> None:
    """Judge a recording in service by what the redundant sensors say of one another; no stand needed."""
    if motion not in ("auto", "still", "any"):
        raise typer.BadParameter(f"motion is {motion!r}; choose auto, still or any")
    result, started_at, away = _result(file, reference, motion)
    if as_json:
        print_json(result.to_dict())
    else:
        screen().print(parity_view(result, started_at, away))


def _result(file: Path, reference: Path, motion: str) -> tuple[ParityResult, str | None, str]:
    """The result, when the recording began, in UTC, and whether that was far from the calibration's temperatures, in
    words; exit code 2 with one line when either file cannot be used."""
    with usable(reference):
        calibration = calibrate(session_in(reference))
    with usable(file):
        recording = open_recording(file)
        head = recording.head
        accumulator = ParityAccumulator(
            head.unit,
            head.sensors,
            calibration,
            kind=head.block,
            sample_rate=head.sample_rate,
            site=head.site,
            count_time=head.count_time,
        )
        for chunk in recording.chunks:
            accumulator.add(chunk)
        celsius = None if head.temperature is None else float(head.temperature.mean())
        away = far_from_reference(celsius, calibration.residuals)
        return accumulator.result(motion=motion), head.started_at, away


def parity_view(result: ParityResult, started_at: str | None, away: str = "") -> RenderableType:
    """The finding in a sentence, its limitation by temperature, then every sensor: its apparent change, and the
    detection limit; where one fails within the recording, by the part before.
    """
    faults, known = faults_in_words(result, started_at), before_faults(result)
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for heading in ("sensor", "visible", *(f"{name}{part}" for name in PARAMETERS for part in ("", ", seen from"))):
        table.add_column(heading, justify="left" if heading == "sensor" else "right", no_wrap=True)
    for sensor in known.sensors:
        cells = [cell for name in PARAMETERS for cell in _cells(result.kind, name, getattr(sensor, name))]
        table.add_row(sensor.name, f"{100 * sensor.visible_share:.0f} %", *cells)
    said = said_of(faults) if faults else f"{found_in_words(result)}."
    return Group(
        Text.assemble((result.unit, "bold"), f": {joined(' ', filter(None, (said, away)))}"),
        *map(Text, parts_in_words(result)),
        Text(f"χ² {result.chi2:.1f} of {result.dof} numbers, p = {result.p_value:.3g}; {_used(result)}."),
        table,
    )


def _cells(kind: str, name: str, sight: Sight) -> tuple[str, str]:
    if sight.size is None or sight.sigma is None or sight.detectable is None:
        return "not observed", "—"
    change = in_words(kind, name, sight.size, signed=name != "axis")
    return f"{change} ± {in_words(kind, name, COVERAGE * sight.sigma)}", in_words(kind, name, sight.detectable)


def _used(result: ParityResult) -> str:
    """The part of the recording that was used."""
    omissions = [f"{count} {why}" for why, count in result.left_out.items() if count]
    dropped = f" ({', '.join(omissions)} left out)" if omissions else ""
    length = "" if result.duration is None else f", {result.duration:,.0f} s"
    return f"{result.used} of {result.blocks} blocks used{dropped}{length}"
