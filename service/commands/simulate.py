"""`imu-health simulate`: session files of a unit whose truth is known."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from estimator.parameters import SensorParameters
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, CalibrationSession
from estimator.simulate import StandDraw, draw_stand, scattered, simulate
from estimator.writing import session_document
from service.commands.console import AsJson, print_json
from service.demo.blocks import ACCELEROMETER_SCALE, MICRO_G, norms, schedule_of
from service.demo.changes import ELEMENT, Change, step_of

FIRST_SESSION = datetime(2026, 1, 12, 9, 0, tzinfo=UTC)
INTERVAL = timedelta(days=60)
DRIFT = re.compile(r"A(?P<sensor>\d+)\.(?P<parameter>\w+)=(?P<amount>[-+]?\d+(\.\d*)?)")


@dataclass(frozen=True)
class Simulated:
    """One simulated session and everything that is true of it."""

    session: CalibrationSession
    truth: SensorParameters
    draw: StandDraw


def read_drift(text: str) -> Change:
    """``A3.bias=20`` as a change; a usage error when it is not of that form."""
    match = DRIFT.fullmatch(text)
    if match is None or match["parameter"] not in ELEMENT or match["sensor"] == "0":
        raise typer.BadParameter(f"{text!r}: write SENSOR.PARAMETER=AMOUNT, for instance A3.bias=20")
    return Change(int(match["sensor"]) - 1, match["parameter"], float(match["amount"]))


def safe_name(unit: str) -> str:
    """The serial number as part of a file's name."""
    return re.sub(r"[^\w.-]", "_", unit)


def simulate_files(
    out: Annotated[Path, typer.Option(help="Folder to write the session files to.")] = Path(),
    unit: Annotated[str, typer.Option(help="Serial number of the unit.")] = "SIM-001",
    sensors: Annotated[int, typer.Option("--sensors", "-m", min=3, max=48, help="Accelerometers on the cone.")] = 6,
    alpha: Annotated[float, typer.Option(min=1, max=89, help="Elevation of the head's axis, degrees.")] = 40.0,
    positions: Annotated[int, typer.Option("--positions", "-n", min=3, max=360, help="Positions a run.")] = 24,
    sessions: Annotated[int, typer.Option(min=1, max=1000, help="Sessions, two months apart.")] = 1,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same files.")] = 1,
    noise: Annotated[float, typer.Option(min=0, help="One sigma of an averaged reading, µg.")] = 2.5,
    drift: Annotated[
        list[str] | None,
        typer.Option(
            help="Change from each session to the next, SENSOR.PARAMETER=AMOUNT: "
            "scale in ppm, bias in µg, quadratic in µg/g², axis in arcsec. May be repeated.",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write session files of a simulated accelerometer block on a two-axis stand; --json prints the truth."""
    changes = tuple(read_drift(text) for text in drift or ())
    if any(change.sensor >= sensors for change in changes):
        raise typer.BadParameter(f"--drift names a sensor that is not there; the block has A1 to A{sensors}")
    schedule = replace(schedule_of(ACCELEROMETER, sensors, "SIM", alpha, positions), unit=unit)
    out.mkdir(parents=True, exist_ok=True)
    for number, simulated in enumerate(_simulated(schedule, changes, sessions, noise, np.random.default_rng(seed)), 1):
        file = out / f"{safe_name(unit)}-{number:03d}.json"
        file.write_text(json.dumps(session_document(simulated.session)), encoding="utf-8")
        if as_json:
            print_json(_truth(file, simulated))
        else:
            typer.echo(str(file))


def _simulated(
    schedule: CalibrationSession, changes: tuple[Change, ...], sessions: int, noise: float, rng: np.random.Generator
) -> Iterator[Simulated]:
    """The unit's sessions in order."""
    count = len(schedule.sensors)
    norm = norms(ACCELEROMETER, count)
    start = scattered(schedule.sensors, norm, rng)
    for number in range(sessions):
        at = FIRST_SESSION + number * INTERVAL
        dated = replace(schedule, started_at=f"{at:%Y-%m-%dT%H:%M:%SZ}", notes="Simulated.")
        truth = start.stepped(number * step_of(changes, count, ACCELEROMETER), norm)
        draw = draw_stand(dated, rng)
        session = simulate(dated, truth, rng, noise=noise * MICRO_G * ACCELEROMETER_SCALE, draw=draw)
        yield Simulated(session, truth, draw)


def _truth(file: Path, simulated: Simulated) -> dict[str, Any]:
    """What a calibration of the file should find, SI; and the stand's errors that it cannot know."""
    truth, stand = simulated.truth, simulated.draw.constant
    return {
        "format": "imu-truth/1",
        "file": str(file),
        "unit": simulated.session.unit,
        "sensors": [
            {
                "name": sensor.name,
                "scale": float(truth.scale[i]),
                "bias": float(truth.bias[i]),
                "quadratic": float(truth.quadratic[i]),
                "axis": truth.axis[i].tolist(),
            }
            for i, sensor in enumerate(simulated.session.sensors)
        ],
        "stand_arcsec": {name: float(getattr(stand, name)) / ARCSEC for name in ("theta_x", "theta_y", "alpha")},
    }
