"""One unit's life: sensors, what each parameter does, sessions, services, and how they came to be on record."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from tests.lives.generator.kinds import KINDS, SEASONAL, STABLE, YEAR, Array, Random, course, temperature_law
from tests.lives.generator.workshop import SET_POINT, Stand, draw_stands, session_days

Sensors = Literal["accelerometers", "gyros", "both"]
PARAMETERS = {"A": ("bias", "scale", "quadratic", "axis"), "G": ("bias", "scale", "axis")}
"""Parameters that move, by the first letter of a sensor's name."""
SERVICED = {"adjustment": 0.0, "repair": 0.3, "service": 0.15}
"""Kinds of service, and one sigma of what a parameter jumps by, T; a transport is entered as a service."""
RECORDED = ("in time", "late", "wrong date")


@dataclass(frozen=True)
class UnitType:
    """A type of units; tolerances in SI (relative for scale), by first letter and parameter."""

    name: str
    sensors: Sensors
    tolerances: dict[tuple[str, str], float]


@dataclass(frozen=True, eq=False)
class Move:
    """Move of one parameter of one sensor; everything else is stable."""

    sensor: str
    parameter: str
    kind: str
    days: Array
    """(days,) T since the first session, services apart."""
    law: tuple[float, float]
    """T per °C and per °C² about the set point."""
    way: float = 0.0
    """rad, of an axis: the direction across it in which it moves."""

    def at(self, day: float, temperature: float) -> float:
        """T since the first day, at a temperature, °C."""
        warm = temperature - SET_POINT
        return float(self.days[int(day)] + self.law[0] * warm + self.law[1] * warm**2)


@dataclass(frozen=True)
class Measured:
    """One session as it truly was."""

    day: int
    stand: int
    temperature: float
    """°C."""


@dataclass(frozen=True)
class Serviced:
    """A service as it truly was, and how it was recorded."""

    day: int
    kind: str
    jump: float
    """T, of the first moving parameter."""
    recorded: str
    """One of `RECORDED`."""


@dataclass(frozen=True, eq=False)
class Life:
    """All that happened to one unit."""

    serial: str
    type: UnitType
    names: tuple[str, ...]
    moves: tuple[Move, ...]
    sessions: tuple[Measured, ...]
    services: tuple[Serviced, ...]
    stands: tuple[Stand, ...]

    def kind(self) -> str:
        """Kind of the first moving parameter; stable if none moves."""
        return self.moves[0].kind if self.moves else STABLE

    def jumped(self, day: float) -> float:
        """T by which services have moved the first moving parameter by a day."""
        return sum(one.jump for one in self.services if one.day <= day)


@dataclass(frozen=True)
class Plan:
    """Kinds and lengths of the lives that are drawn."""

    shares: tuple[tuple[str, float], ...] = tuple((kind, 1.0) for kind in KINDS)
    """Frequency of each kind of life, up to a factor."""
    years: tuple[float, float] = (2.5, 6.0)
    """Shortest and longest."""
    services: float = 0.15
    """A year."""

    def bad(self, share: float) -> "Plan":
        """The plan with a share of units that are not stable, all other kinds alike."""
        others = [kind for kind in KINDS if kind != STABLE]
        return replace(self, shares=((STABLE, 1 - share), *((kind, share / len(others)) for kind in others)))


def draw_type(number: int, sensors: Sensors, rng: Random) -> UnitType:
    """A type with tolerances of its own."""
    arcsec, g, wide = np.pi / 648_000, 9.80665, rng.uniform(0.8, 2.0, 7)
    usual = {("A", "bias"): 50e-6 * g, ("A", "scale"): 1e-4, ("A", "quadratic"): 20e-6 / g, ("A", "axis"): 20 * arcsec,
             ("G", "bias"): 2.4e-7, ("G", "scale"): 1e-3, ("G", "axis"): 120 * arcsec}  # fmt: skip
    tolerances = {key: float(factor * size) for factor, (key, size) in zip(wide, usual.items(), strict=True)}
    return UnitType(f"Lived {number}", sensors, tolerances)


def draw_life(
    serial: str, type_: UnitType, rng: Random, plan: Plan | None = None, stands: tuple[Stand, ...] = ()
) -> Life:
    """One unit's life; units of one workshop share ``stands``, which are drawn where none are given."""
    plan, stands = plan or Plan(), stands or draw_stands(rng)
    letters = {"accelerometers": ("A",) * 6, "gyros": ("G",) * 6, "both": ("A",) * 3 + ("G",) * 3}[type_.sensors]
    names = tuple(f"{letter}{i + 1}" for i, letter in enumerate(letters))
    kinds, shares = zip(*plan.shares, strict=True)
    kind = str(rng.choice(kinds, p=np.array(shares) / sum(shares)))
    days = session_days(rng.uniform(*plan.years), rng)
    home = int(rng.integers(len(stands)))
    at = np.where(rng.random(len(days)) < 0.75, home, rng.integers(len(stands), size=len(days)))
    warm = [float(stands[i].air[day] + 0.3 * rng.standard_normal()) for i, day in zip(at, days, strict=True)]
    return Life(
        serial=serial,
        type=type_,
        names=names,
        moves=() if kind == STABLE else (_move(kind, names, rng),),
        sessions=tuple(Measured(int(d), int(i), w) for d, i, w in zip(days, at, warm, strict=True)),
        services=_services(float(days[-1]), plan.services, rng),
        stands=stands,
    )


def _move(kind: str, names: tuple[str, ...], rng: Random) -> Move:
    sensor = str(rng.choice(names))
    allowed = PARAMETERS[sensor[0]] if kind != SEASONAL else ("bias", "scale")
    parameter = str(rng.choice(allowed))
    return Move(
        sensor, parameter, kind, course(kind, rng), temperature_law(kind, rng), float(rng.uniform(0, 2 * np.pi))
    )


def _services(last: float, rate: float, rng: Random) -> tuple[Serviced, ...]:
    """Services at times of their own, whatever the unit does."""
    days = np.sort(rng.uniform(30, max(last, 31), rng.poisson(rate * last / YEAR))).astype(int)
    kinds = [str(rng.choice(list(SERVICED))) for _ in days]
    recorded = [str(rng.choice(RECORDED, p=(0.6, 0.25, 0.15))) for _ in days]
    found = zip(days, kinds, recorded, strict=True)
    return tuple(Serviced(int(d), k, float(SERVICED[k] * rng.standard_normal()), how) for d, k, how in found)
