"""Options and answer file of `imu-health simulate --hide`."""

import json
import re
from dataclasses import dataclass, replace
from math import ceil
from pathlib import Path
from typing import Annotated, NoReturn

import numpy as np
import typer

from estimator.causes import CATALOGUE, Cause, find
from estimator.errors import SessionError
from estimator.hiding import HiddenCause, TooWeakError, UnhideableError, hide, hide_any
from estimator.json_object import Json
from estimator.session import CALIBRATIONS, GYROSCOPE, TWO_AXIS_STAND, CalibrationSession
from service.commands.speech import UNUSABLE, say

ANY = "random"
"""Written in place of a cause: one drawn by the seed."""
DEFAULT_STRENGTH = 12.0
"""Standard errors: clearly detected, but not visible to the eye."""
RANDOM_STREAM = 14
"""Stream of random numbers beside the seed, so that the other readings are the same as without --hide."""
REMEDY = {"temperature": "give --warming 3", "history": "give --sessions 2"}
"""Option that provides what a cause needs."""
ROOM_TEMPERATURE = 21.0
"""°C, at the first row."""
WARMEST = 0.35
"""Fraction of the session at which the room is warmest: a course of neither time nor the head's angle."""
NamedCause = Annotated[
    str | None,
    typer.Option(
        "--hide",
        help="Cause to hide in the last session, as `docs/diagnosis/causes.md` calls it; `random` draws one.",
        show_default=False,
    ),
]
Strength = Annotated[
    float | None,
    typer.Option(
        min=1,
        help="Of what is hidden, in standard errors of a reading.",
        show_default=f"{DEFAULT_STRENGTH:g}, or the least that can be",
    ),
]
OnSensor = Annotated[
    str | None, typer.Option("--sensor", help="The sensor to have it, such as A2.", show_default="drawn by the seed")
]
Answer = Annotated[
    Path | None, typer.Option(help="File to write what is hidden to; nothing else tells it.", show_default=False)
]
Warming = Annotated[
    float, typer.Option(min=0, max=40, help="Rise and fall of the room's temperature in a session, °C; it is recorded.")
]


@dataclass(frozen=True)
class HidingRequest:
    """Request for a hidden cause."""

    cause: Cause | None
    """Requested cause; None for any."""
    strength: float
    exact: bool
    """Whether that strength was requested."""
    sensor: str | None
    """Name of the affected sensor; None where the seed draws one."""
    answer: Path | None


def read_request(
    cause: str | None, strength: float | None, sensor: str | None, answer: Path | None, programme: str
) -> HidingRequest | None:
    """The options as one request; None without --hide, a usage error for contradictory options."""
    if cause is None:
        if (strength, sensor, answer) != (None, None, None):
            raise typer.BadParameter("--strength, --sensor and --answer belong to --hide, which is not given")
        return None
    known = None if cause == ANY else find(cause)
    if cause != ANY and known is None:
        names = ", ".join(c.identifier for c in CATALOGUE)
        raise typer.BadParameter(f"--hide {cause}: no such cause; give {ANY} or one of {names}")
    if sensor is not None and not re.fullmatch(r"[AG][1-9]\d?", sensor):
        raise typer.BadParameter(f"--sensor {sensor}: name one of the block, for instance A2")
    if cause == "lever-arm":
        refuse("lever-arm is of a turntable; give --programme rotation-alignment --lever-arm A2=4,-1.5")
    if programme not in CALIBRATIONS:
        refuse(f"{programme} shows none of the causes that can be hidden; {TWO_AXIS_STAND} does")
    if known is not None and strength is not None and not known.units:
        refuse(f"{known.identifier} is there or not, and has no strength; leave --strength out")
    return HidingRequest(known, strength or DEFAULT_STRENGTH, strength is not None, sensor, answer)


def hidden_in(
    sessions: list[CalibrationSession], request: HidingRequest, seed: int
) -> tuple[CalibrationSession, HiddenCause]:
    """The last session before its pulses are counted, with the requested cause in it; exit code 2 with a sentence where
    that is impossible."""
    rng = np.random.default_rng([seed, RANDOM_STREAM])
    names = [s.name for s in sessions[-1].sensors]
    if request.sensor is not None and request.sensor not in names:
        refuse(f"--sensor {request.sensor} is not there; the block has {names[0]} to {names[-1]}")
    sensor = None if request.sensor is None else names.index(request.sensor)
    try:
        if request.cause is None:
            return hide_any(sessions, rng, strength=request.strength, sensor=sensor, exact=request.exact)
        return hide(sessions, request.cause, rng, strength=request.strength, sensor=sensor, exact=request.exact)
    except TooWeakError as fault:
        refuse(f"{fault}; give --strength {ceil(fault.least)}, or more --positions")
    except UnhideableError as fault:
        remedy = "" if request.cause is None else _remedy(request.cause, sessions)
        refuse(f"{fault}{remedy}")
    except SessionError as fault:
        refuse(str(fault))


def _remedy(cause: Cause, sessions: list[CalibrationSession]) -> str:
    """The option that provides a missing condition: ``; give --warming 3``."""
    if "gravity" in cause.needs and sessions[-1].stand is not None:
        return "; give --programme arbitrary-orientations"
    if cause.kind == GYROSCOPE and all(sensor.kind != GYROSCOPE for sensor in sessions[-1].sensors):
        return "; give --block gyroscope"
    present = {"temperature": sessions[-1].temperature is not None, "history": len(sessions) > 1}
    needs = cause.needs | ({"history"} if cause.between and cause.units else frozenset())
    options = [option for name, option in REMEDY.items() if name in needs and not present[name]]
    return "".join(f"; {option}" for option in options)


def refuse(sentence: str) -> NoReturn:
    """One line on standard error, and exit code 2."""
    say(f"--hide: {sentence}")
    raise typer.Exit(UNUSABLE)


def write_answer(hidden: HiddenCause, file: Path, session: CalibrationSession, target: Path) -> None:
    """Writes the cause hidden in ``file`` to ``target``, sensors by name and rows counted from 1."""
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(_answer(hidden, file, session), ensure_ascii=False), encoding="utf-8")


def _answer(hidden: HiddenCause, file: Path, session: CalibrationSession) -> Json:
    known = find(hidden.cause)
    assert known is not None
    return {
        "format": "imu-hidden/1",
        "file": str(file),
        "unit": session.unit,
        "cause": hidden.cause,
        "sensors": [session.sensors[i].name for i in hidden.sensors],
        "rows": [row + 1 for row in hidden.rows],
        "amplitude": list(hidden.amplitude),
        "units": [_unit(unit, hidden, session) for unit in known.units],
        "shape": [v + (unit == "row") for v, unit in zip(hidden.nonlinear, known.nonlinear_units, strict=False)],
        "shape_units": [_unit(unit, hidden, session) for unit in known.nonlinear_units],
        "strength": hidden.strength,
    }


def _unit(unit: str, hidden: HiddenCause, session: CalibrationSession) -> str:
    """The unit of a size at the input, which is a rate for a gyro."""
    on_gyro = any(session.sensors[i].kind == GYROSCOPE for i in hidden.sensors)
    return "rad/s" if on_gyro and unit == "m/s²" else unit


def warmed(schedule: CalibrationSession, rise: float) -> CalibrationSession:
    """The schedule in a room that warms by some °C and cools again; without any, no temperature is recorded."""
    if not rise:
        return schedule
    assert schedule.time is not None
    fraction = schedule.time / schedule.time[-1] / WARMEST
    return replace(schedule, temperature=np.round(ROOM_TEMPERATURE + rise * fraction * np.exp(1 - fraction), 2))
