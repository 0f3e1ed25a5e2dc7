"""`imu-health simulate`: session files of a unit whose truth is known."""

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from math import ceil
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from estimator.alignment.simulate import Truth
from estimator.json_object import Json
from estimator.parameters import SensorParameters
from estimator.results import ARCSEC
from estimator.session import (
    ACCELEROMETER,
    ARBITRARY_ORIENTATIONS,
    GYROSCOPE,
    IN_SERVICE,
    RATE_TABLE,
    ROTATION_ALIGNMENT,
    SIMULATED,
    THERMAL,
    TWO_AXIS_STAND,
    Array,
    CalibrationSession,
)
from estimator.simulate import StandDraw, draw_stand, scattered, uncounted, whole_pulses
from estimator.thermal.simulate import ThermalLaw, over_temperature, thermal_schedule, usual_law
from estimator.writing import session_document
from service.commands.console import AsJson, print_json
from service.commands.hiding import (
    Answer,
    HidingRequest,
    NamedCause,
    OnSensor,
    Strength,
    Warming,
    hidden_in,
    read_request,
    warmed,
    write_answer,
)
from service.demo.blocks import ELEMENT, ELEVATION_DEG, MICRO, MICRO_G, ParameterMove, norms_of, schedule_of, step_of
from service.demo.other_programmes import RATE_NOISE, alignment, orientations, rate_table, recording, turntable_truth

USUAL_NOISE = {ACCELEROMETER: 2.5, GYROSCOPE: 0.3}
"""One sigma of an averaged reading, unless another is asked for: µg; pulses."""
Block = Annotated[
    str, typer.Option(help=f"What they are, {ACCELEROMETER} or {GYROSCOPE}: on a stand, gyros count pulses.")
]
Noise = Annotated[
    float | None,
    typer.Option(min=0, help="One sigma of an averaged reading, µg; of gyros pulses.", show_default="2.5; 0.3"),
]
FIRST_SESSION = datetime(2026, 1, 12, 9, 0, tzinfo=UTC)
"""Fixed, so that the same seed gives the same files wherever the clock is past them."""
INTERVAL = timedelta(days=60)
"""Time from one session to the next: two months, as the help says."""
MOST_AFTER = 4
"""Sessions that are dated from the first date on; those of a longer series end with them."""
FLIGHT_AFTER = timedelta(days=30)
"""Time from a calibration to the recording in service that follows it."""
KNOWN = (TWO_AXIS_STAND, ARBITRARY_ORIENTATIONS, IN_SERVICE, ROTATION_ALIGNMENT, RATE_TABLE, THERMAL)
"""Programmes that can be simulated."""
STILL: dict[str, Callable[[CalibrationSession, np.random.Generator], CalibrationSession]] = {
    ARBITRARY_ORIENTATIONS: lambda schedule, _: schedule,
    THERMAL: thermal_schedule,
}
"""Programmes of still orientations, with the function that makes their schedule."""
ON_TURNTABLE = (ROTATION_ALIGNMENT, RATE_TABLE)
"""Programmes of a turntable, which has no two-axis stand's geometry."""
STAND_ERRORS = ("theta_x", "theta_y", "alpha")
"""Errors of the stand that stay the same over a session and are written with the truth."""
DRIFT = re.compile(r"[AG](?P<sensor>\d+)\.(?P<parameter>\w+)=(?P<amount>[-+]?\d+(\.\d*)?)")
"""SENSOR.PARAMETER=AMOUNT."""
LEVER = re.compile(r"A(?P<sensor>[1-3])=(?P<x>[-+]?\d+(\.\d*)?),(?P<y>[-+]?\d+(\.\d*)?)")
"""SENSOR=X,Y."""
CENTIMETRE = 0.01
"""m."""
Drifts = Annotated[
    list[str] | None,
    typer.Option(
        help="Change from each session to the next, SENSOR.PARAMETER=AMOUNT: "
        "scale in ppm, bias in µg (of gyros °/h), quadratic in µg/g², axis in arcsec. May be repeated.",
        show_default=False,
    ),
]
Levers = Annotated[
    list[str] | None,
    typer.Option(
        help="Where an accelerometer stands from the axis in rotation-alignment, SENSOR=X,Y in cm. May be repeated.",
        show_default=False,
    ),
]


@dataclass(frozen=True)
class Simulated:
    """One simulated session and everything that is true of it."""

    session: CalibrationSession
    """Session before its pulses are counted."""
    truth: SensorParameters | Truth
    draw: StandDraw | None
    """Errors of the stand; None without a stand."""
    law: ThermalLaw | None = None
    """Effect of temperature; None where a programme holds it."""


def read_drift(text: str) -> ParameterMove:
    """``A3.bias=20`` as a change; a usage error when it is not of that form."""
    match = DRIFT.fullmatch(text)
    if match is None or match["parameter"] not in ELEMENT or match["sensor"] == "0":
        raise typer.BadParameter(f"{text!r}: write SENSOR.PARAMETER=AMOUNT, for instance A3.bias=20")
    return ParameterMove(int(match["sensor"]) - 1, match["parameter"], float(match["amount"]))


def read_levers(texts: list[str]) -> Array | None:
    """(6, 3) m: ``A2=4,-1`` as the place of A2 from the turn axis, of all others on it; None without any."""
    matches = [LEVER.fullmatch(text) for text in texts]
    wrong = next((text for text, match in zip(texts, matches, strict=True) if match is None), None)
    if wrong is not None:
        raise typer.BadParameter(f"{wrong!r}: write SENSOR=X,Y in cm from the turn axis, for instance A2=4,-1.5")
    places = np.zeros((6, 3))
    for match in filter(None, matches):
        places[int(match["sensor"]) - 1, :2] = CENTIMETRE * float(match["x"]), CENTIMETRE * float(match["y"])
    return places if matches else None


def check_drift(block: str, programme: str, sensors: int, drift: list[str]) -> None:
    """A usage error where a drift is of no sensor of the block, or does not show in the programme."""
    changes = tuple(map(read_drift, drift))
    letter = block[0].upper()
    if any(change.sensor >= sensors for change in changes) or any(text[0] != letter for text in drift):
        named = f"{letter}1 to {letter}{sensors}"
        raise typer.BadParameter(f"--drift names a sensor that is not there; the block has {named}")
    if programme in ON_TURNTABLE and any(c.parameter != "bias" or c.sensor > 1 for c in changes):
        raise typer.BadParameter(f"--drift: {programme} shows A1.bias and A2.bias only, the biases of x and y")


def safe_name(unit: str) -> str:
    """The serial number as part of a file's name."""
    return re.sub(r"[^\w.-]", "_", unit)


def simulate_files(
    *,
    out: Annotated[Path, typer.Option(help="Folder to write the session files to.")] = Path(),
    unit: Annotated[str, typer.Option(help="Serial number of the unit.")] = "SIM-001",
    sensors: Annotated[int, typer.Option("--sensors", "-m", min=3, max=48, help="Sensors on the cone.")] = 6,
    block: Block = ACCELEROMETER,
    positions: Annotated[int, typer.Option("--positions", "-n", min=3, max=360, help="Positions a run.")] = 24,
    sessions: Annotated[int, typer.Option(min=1, max=500, help="Sessions, two months apart.")] = 1,
    seed: Annotated[int, typer.Option(min=0, help="The same seed and serial number give the same files.")] = 1,
    noise: Noise = None,
    drift: Drifts = None,
    lever_arm: Levers = None,
    programme: Annotated[str, typer.Option(help=f"One of {', '.join(KNOWN)}.")] = TWO_AXIS_STAND,
    warming: Warming = 0.0,
    hide: NamedCause = None,
    strength: Strength = None,
    sensor: OnSensor = None,
    answer: Answer = None,
    as_json: AsJson = False,
) -> None:
    """Write session files of a simulated block: six accelerometers on a two-axis stand unless told otherwise.

    `in-service` is a flight of the block that the same seed and serial number put on the stand, a month after each of
    its sessions; its drift shows from the first on. `arbitrary-orientations` is of accelerometers and as many rate
    gyros, held still in so many positions, `thermal` the same at soaks from −40 to 70 °C and back. `rotation-alignment`
    and `rate-table` are of three accelerometers and three gyros on a turntable; there only the bias drifts, of A1 and
    A2, the axes x and y. --json prints the truth.

    --hide puts a cause of the catalogue into the last session, for `imu-health diagnose` to find. Neither the file nor
    --json tells it; --answer does, and with the same options and seed it can be had later. Every file says that it is
    simulated, so that it counts for no measured unit, and none is dated in the future.
    """
    changes = tuple(read_drift(text) for text in drift or ())
    if programme not in KNOWN:
        raise typer.BadParameter(f"--programme is {programme}; give one of {', '.join(KNOWN)}")
    check_block(block, programme)
    check_drift(block, programme, sensors, drift or [])
    levers = read_levers(lever_arm or [])
    if levers is not None and programme != ROTATION_ALIGNMENT:
        raise typer.BadParameter(f"--lever-arm: {programme} does not show it; {ROTATION_ALIGNMENT} does")
    if warming and programme != TWO_AXIS_STAND:
        raise typer.BadParameter(f"--warming: {programme} records no temperature; {TWO_AXIS_STAND} does")
    wish = read_request(hide, strength, sensor, answer, programme)
    rng = np.random.default_rng([seed, *unit.encode()])
    if programme in STILL:
        schedule = STILL[programme](orientations(unit, sensors, positions, rng), rng)
    else:
        schedule = warmed(replace(schedule_of(block, sensors, "SIM", ELEVATION_DEG, positions), unit=unit), warming)
    made = (
        _turned(unit, programme, changes, sessions, rng, levers=levers)
        if programme in ON_TURNTABLE
        else _simulated(schedule, changes, sessions, noise, rng, in_service=programme == IN_SERVICE)
    )
    back = back_from_future(sessions, programme, datetime.now(UTC))
    _write((_earlier(session, back) for session in made), wish, seed, f"{out}/{safe_name(unit)}", as_json=as_json)


def _write(made: Iterator[Simulated], wish: HidingRequest | None, seed: int, start: str, *, as_json: bool) -> None:
    """The sessions as files that begin with ``start``; nothing is written of what cannot be hidden."""
    if wish is not None:
        *before, last = made
        session, hidden = hidden_in([*(whole_pulses(s.session) for s in before), last.session], wish, seed)
        made = iter((*before, replace(last, session=session)))
    for number, simulated in enumerate(made, 1):
        programme = simulated.session.programme
        prefix = "" if programme == TWO_AXIS_STAND else f"{programme}-"
        file = Path(f"{start}-{prefix}{number:03d}.json")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(session_document(whole_pulses(simulated.session))), encoding="utf-8")
        if as_json:
            print_json(_truth(file, simulated))
        else:
            typer.echo(str(file))
    if wish is not None and wish.answer is not None:
        write_answer(hidden, file, session, wish.answer)


def back_from_future(sessions: int, programme: str, now: datetime) -> timedelta:
    """Shift of all sessions to earlier dates so that none lies after ``now``: as a rule zero."""
    last = _measured(sessions - 1, sessions) + (FLIGHT_AFTER if programme == IN_SERVICE else timedelta())
    return INTERVAL * max(0, ceil((last - now) / INTERVAL))


def _earlier(simulated: Simulated, back: timedelta) -> Simulated:
    assert simulated.session.started_at is not None
    at = datetime.fromisoformat(simulated.session.started_at) - back
    return replace(simulated, session=_dated(simulated.session, at))


def _simulated(
    schedule: CalibrationSession,
    changes: tuple[ParameterMove, ...],
    sessions: int,
    noise: float | None,
    rng: np.random.Generator,
    *,
    in_service: bool,
) -> Iterator[Simulated]:
    """The unit's sessions in order, or a flight after each of them, when the next drift has come."""
    count = len(schedule.sensors)
    norm = norms_of(schedule.sensors)
    start = scattered(schedule.sensors, norm, rng)
    law = usual_law(schedule.sensors, rng) if schedule.programme == THERMAL else None
    for number in range(sessions):
        at = _measured(number, sessions)
        truth = start.stepped((number + in_service) * step_of(changes, count, schedule.block), norm)
        if in_service:
            flight = recording(schedule.unit, schedule.sensors, truth, rng)
            yield Simulated(_dated(flight, at + FLIGHT_AFTER), truth, None)
            continue
        dated = _dated(schedule, at)
        draw = draw_stand(dated, rng) if schedule.stand is not None else None
        session = uncounted(dated, truth, rng, noise=noise_of(schedule, noise), draw=draw)
        yield Simulated(session if law is None else over_temperature(session, truth, law), truth, draw, law)


def _turned(
    unit: str,
    programme: str,
    changes: tuple[ParameterMove, ...],
    sessions: int,
    rng: np.random.Generator,
    *,
    levers: Array | None,
) -> Iterator[Simulated]:
    make = alignment if programme == ROTATION_ALIGNMENT else rate_table
    start, drifts = 20.0 * rng.standard_normal(2), 0.01 * rng.standard_normal(3)
    moved = step_of(changes, 2, ACCELEROMETER)
    for number in range(sessions):
        zeros = np.append(start + number * moved[:2, ELEMENT["bias"]] / MICRO, 0.0)
        truth = replace(turntable_truth(zeros, drifts, rng), positions=levers)
        session = make(unit, truth, rng)
        yield Simulated(_dated(session, _measured(number, sessions)), truth, None)


def _measured(number: int, sessions: int) -> datetime:
    """Date of a session of so many. Nothing is measured in the future, so a long series begins earlier."""
    return FIRST_SESSION + (number - max(sessions - MOST_AFTER, 0)) * INTERVAL


def _dated(session: CalibrationSession, at: datetime) -> CalibrationSession:
    return replace(session, started_at=f"{at:%Y-%m-%dT%H:%M:%SZ}", notes="Simulated.", origin=SIMULATED)


def _truth(file: Path, simulated: Simulated) -> Json:
    """The truth that the file should show, SI, and the stand's errors that a calibration cannot know."""
    head = {"format": "imu-truth/1", "file": str(file), "unit": simulated.session.unit}
    if isinstance(simulated.truth, Truth):
        return {**head, **_turntable(simulated.truth)}
    return {**head, **_sensors(simulated, simulated.truth)}


def _turntable(truth: Truth) -> Json:
    return {
        "accelerometer_bias": truth.accelerometer_bias.tolist(),
        "gyro_bias": truth.gyro_bias.tolist(),
        "mounting": list(truth.mounting),
        "kappa": truth.kappa,
        "positions_m": None if truth.positions is None else truth.positions[:3].tolist(),
    }


def _sensors(simulated: Simulated, truth: SensorParameters) -> Json:
    stand = None if simulated.draw is None else simulated.draw.constant
    errors: Json = {} if stand is None else {"stand_arcsec": {k: getattr(stand, k) / ARCSEC for k in STAND_ERRORS}}
    if simulated.law is not None:
        errors = {
            "scale_by_temperature": simulated.law.scale.tolist(),
            "bias_by_temperature": simulated.law.bias.tolist(),
        }
    return {
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
        **errors,
    }


def check_block(block: str, programme: str) -> None:
    """A usage error where a programme is not simulated of such a block."""
    if block not in USUAL_NOISE:
        raise typer.BadParameter(f"--block is {block}; give {ACCELEROMETER} or {GYROSCOPE}")
    if block == GYROSCOPE and programme != TWO_AXIS_STAND:
        raise typer.BadParameter(f"--block {block}: {programme} does not show it; {TWO_AXIS_STAND} does")


def noise_of(schedule: CalibrationSession, noise: float | None) -> Array:
    """(m,) one sigma of an averaged reading, reading units: ``noise`` is µg, of a block of pulse gyros pulses."""
    level = USUAL_NOISE[schedule.block] if noise is None else noise
    found = [MICRO_G * level * s.nominal_scale if s.kind == ACCELEROMETER else RATE_NOISE for s in schedule.sensors]
    return np.array(found) if schedule.count_time is None else np.full(len(found), level)
