"""What `imu-health simulate --hide` hides, how it is asked for, and where the answer goes."""

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
from estimator.hiding import Hidden, TooWeakError, UnhideableError, hide, hide_any
from estimator.json_object import Json
from estimator.session import CALIBRATIONS, GYROSCOPE, TWO_AXIS_STAND, CalibrationSession
from service.commands.speech import UNUSABLE, say

ANY = "random"
"""As the cause: one that the seed draws."""
USUAL = 12.0
"""Standard errors: plainly seen, and not yet seen by eye."""
OWN_STREAM = 14
"""Beside the seed, so that without what is hidden the readings are the same as without --hide."""
REMEDY = {"temperature": "give --warming 3", "history": "give --sessions 2"}
"""What a session can be given that a cause needs."""
ROOM = 21.0
"""°C, at the first row."""
WARMEST = 0.35
"""Of the session, when the room is warmest: a course that neither time nor the head's angle has."""
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
        show_default=f"{USUAL:g}, or the least that can be",
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
class Wish:
    """What is to be hidden."""

    cause: Cause | None
    """None for any."""
    strength: float
    exact: bool
    """Whether that strength was asked for."""
    sensor: str | None
    """Name of the one to have it; None where the seed draws one."""
    answer: Path | None


def read_wish(
    cause: str | None, strength: float | None, sensor: str | None, answer: Path | None, programme: str
) -> Wish | None:
    """The options as one wish; None without --hide, a usage error where they do not fit one another."""
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
    return Wish(known, strength or USUAL, strength is not None, sensor, answer)


def hidden_in(sessions: list[CalibrationSession], wish: Wish, seed: int) -> tuple[CalibrationSession, Hidden]:
    """The last session, its pulses not counted yet, with what is wished for in it; exit code 2 with a sentence where
    that cannot be."""
    rng = np.random.default_rng([seed, OWN_STREAM])
    names = [one.name for one in sessions[-1].sensors]
    if wish.sensor is not None and wish.sensor not in names:
        refuse(f"--sensor {wish.sensor} is not there; the block has {names[0]} to {names[-1]}")
    sensor = None if wish.sensor is None else names.index(wish.sensor)
    try:
        if wish.cause is None:
            return hide_any(sessions, rng, strength=wish.strength, sensor=sensor, exact=wish.exact)
        return hide(sessions, wish.cause, rng, strength=wish.strength, sensor=sensor, exact=wish.exact)
    except TooWeakError as fault:
        refuse(f"{fault}; give --strength {ceil(fault.least)}, or more --positions")
    except UnhideableError as fault:
        lacking = "" if wish.cause is None else _remedy(wish.cause, sessions)
        refuse(f"{fault}{lacking}")
    except SessionError as fault:
        refuse(str(fault))


def _remedy(cause: Cause, sessions: list[CalibrationSession]) -> str:
    """``; give --warming 3`` where an option would provide what lacks."""
    if "gravity" in cause.needs and sessions[-1].stand is not None:
        return "; give --programme arbitrary-orientations"
    if cause.kind == GYROSCOPE and all(sensor.kind != GYROSCOPE for sensor in sessions[-1].sensors):
        return "; give --block gyroscope"
    has = {"temperature": sessions[-1].temperature is not None, "history": len(sessions) > 1}
    needs = cause.needs | ({"history"} if cause.between and cause.units else frozenset())
    ways = [way for need, way in REMEDY.items() if need in needs and not has[need]]
    return "".join(f"; {way}" for way in ways)


def refuse(sentence: str) -> NoReturn:
    """One line on standard error, and exit code 2."""
    say(f"--hide: {sentence}")
    raise typer.Exit(UNUSABLE)


def write_answer(hidden: Hidden, file: Path, session: CalibrationSession, target: Path) -> None:
    """What is hidden in ``file``, sensors by name and rows counted from 1."""
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(_answer(hidden, file, session), ensure_ascii=False), encoding="utf-8")


def _answer(hidden: Hidden, file: Path, session: CalibrationSession) -> Json:
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


def _unit(unit: str, hidden: Hidden, session: CalibrationSession) -> str:
    """Of a size at the input, which of a gyro is a rate."""
    on_gyro = any(session.sensors[i].kind == GYROSCOPE for i in hidden.sensors)
    return "rad/s" if on_gyro and unit == "m/s²" else unit


def warmed(schedule: CalibrationSession, by: float) -> CalibrationSession:
    """The schedule in a room that warms by so many °C and cools again; without any, nobody looks at a thermometer."""
    if not by:
        return schedule
    assert schedule.time is not None
    passed = schedule.time / schedule.time[-1] / WARMEST
    return replace(schedule, temperature=np.round(ROOM + by * passed * np.exp(1 - passed), 2))
