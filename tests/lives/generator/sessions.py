"""A life as session files, made with the physics of `tests.blind`: an own model of the stand and of the sensors."""

from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from tests.blind.physics import measure
from tests.blind.world import ARCSEC, Noise, Schedule, Session, Site, Stand, StandSigma, Unit
from tests.blind.write import session_file
from tests.lives.generator.kinds import Array, Random
from tests.lives.generator.life import Life, Measured, Move

BEGIN = datetime(2020, 1, 8, 8, 30, tzinfo=UTC)
"""Day 0 of every life."""
POSITIONS = 12
"""A run, direct and flipped."""
ALPHA = np.radians(40.0)
SITE = Site(np.radians(55.81), 160.0, None)
GYRO_SCALE, SCALE = 1e6, 0.12
"""Reading units per rad/s, and per m/s²."""


@dataclass(frozen=True, eq=False)
class Block:
    """The unit as it left the assembly."""

    unit: Unit
    noise: Noise


def draw_block(life: Life, rng: Random) -> Block:
    """A block with the sensors of its life; their errors are those of good units."""
    gyro = np.array([name[0] == "G" for name in life.names])
    m = len(gyro)
    nominal = np.concatenate([_cone(int(np.sum(gyro == kind))) for kind in (False, True)])
    scale = np.where(gyro, GYRO_SCALE, SCALE)
    unit = Unit(
        name=life.serial,
        names=life.names,
        gyro=gyro,
        nominal_axis=nominal,
        nominal_scale=scale,
        reading_unit=("V",) * m,
        scale=scale * (1 + 3e-4 * rng.standard_normal(m)),
        bias=np.where(gyro, 2e-8, 1e-3) * rng.standard_normal(m),
        quadratic=np.where(gyro, 0.0, 1e-6) * rng.standard_normal(m),
        axis=_unit_length(nominal + 1e-4 * rng.standard_normal((m, 3))),
    )
    return Block(unit, Noise(np.where(gyro, 1e-8, 2.5e-5), np.where(gyro, 3e-8, 5e-5)))


def session_of(life: Life, block: Block, of: Measured, rng: Random) -> dict[str, Any]:
    """One session, ``imu-session/1``; also as it would have been on another day, stand or temperature."""
    stand = life.stands[of.stand]
    jump = life.jumped(of.day)
    unit = block.unit
    for i, move in enumerate(life.moves):
        unit = moved(unit, move, life.type.tolerances, move.at(of.day, of.temperature) + (jump if i == 0 else 0.0))
    sits = Rotation.from_rotvec(stand.turned(of.day) + stand.seating * rng.standard_normal(3))
    session = Session(
        unit=replace(unit, axis=sits.apply(unit.axis)),
        schedule=_schedule(of.temperature),
        site=SITE,
        stand=Stand(stand.name, ALPHA, ALPHA, StandSigma(0.33 * ARCSEC, 0.33 * ARCSEC, ARCSEC, ARCSEC)),
        mounting=np.eye(3),
        noise=block.noise,
        started_at=started_at(of.day),
    )
    made = session_file(session, measure(session, (), rng)[0])
    return {**made, "unit_type": life.type.name}


def started_at(day: float) -> str:
    """Start of a session with its offset, as a stand's clock writes it."""
    return (BEGIN + timedelta(days=float(day))).isoformat()


def moved(unit: Unit, move: Move, tolerances: dict[tuple[str, str], float], by: float) -> Unit:
    """The unit with one parameter moved by so many tolerances."""
    i, size = unit.names.index(move.sensor), by * tolerances[move.sensor[0], move.parameter]
    if move.parameter == "axis":
        axis = unit.axis.copy()
        axis[i] = _unit_length(axis[i] + np.tan(size) * _across(axis[i], move.way))
        return replace(unit, axis=axis)
    values = getattr(unit, move.parameter).copy()
    values[i] = values[i] * (1 + size) if move.parameter == "scale" else values[i] + size
    return replace(unit, **{move.parameter: values})


def _across(axis: Array, way: float) -> Array:
    """(3,) a unit vector across an axis (3,)."""
    first = _unit_length(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]))
    return np.asarray(np.cos(way) * first + np.sin(way) * np.cross(axis, first))


def _cone(m: int) -> Array:
    """(m, 3) nominal axes, evenly about Y, 50° from it."""
    turn, half = 2 * np.pi * np.arange(m) / max(m, 1) + 0.1, np.radians(50.0)
    return np.stack([np.sin(half) * np.cos(turn), np.full(m, np.cos(half)), np.sin(half) * np.sin(turn)], axis=1)


def _unit_length(axes: Array) -> Array:
    return np.asarray(axes / np.linalg.norm(axes, axis=-1, keepdims=True))


def _schedule(temperature: float) -> Schedule:
    """Two runs; the block warms by some tenths of a degree while it is measured."""
    rows = 2 * POSITIONS
    time = 180.0 * np.arange(rows)
    return Schedule(
        flipped=np.repeat([False, True], POSITIONS),
        beta=np.tile(2 * np.pi * np.arange(POSITIONS) / POSITIONS, 2),
        time=time,
        temperature=np.round(temperature + 0.2 * time / time[-1], 3),
        temperature_rate=np.full(rows, 0.2 / time[-1]),
    )
