"""The simulated world: a unit, a stand, a schedule, and one session of them. SI throughout; angles in rad."""

from dataclasses import dataclass, field

import numpy as np

EARTH_RATE = 7.292115e-5
ARCSEC = np.pi / 648_000
STANDARD_G = 9.80665
Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Unit:
    """m sensors: what the maker states, and what is true."""

    name: str
    names: tuple[str, ...]
    gyro: Array
    """(m,) bool."""
    nominal_axis: Array
    nominal_scale: Array
    """(m,) reading units per m/s² or rad/s."""
    reading_unit: tuple[str, ...]
    scale: Array
    bias: Array
    quadratic: Array
    axis: Array

    @property
    def size(self) -> int:
        """Number of sensors."""
        return len(self.names)


@dataclass(frozen=True, eq=False)
class Schedule:
    """R rows in the order measured."""

    flipped: Array
    beta: Array
    time: Array
    temperature: Array
    temperature_rate: Array
    """(R,) true dT/dt, °C/s."""
    timed: bool = True
    """Whether the file states the time."""
    thermometer: bool = True
    """Whether the file states the temperature."""
    vibration: Array | None = None
    """(R,) m/s², rms of what shakes the block while it is averaged; None where it was not watched."""

    @property
    def rows(self) -> int:
        """R."""
        return len(self.beta)

    @property
    def both_runs(self) -> bool:
        """Whether there is a direct and a flipped run."""
        return bool(self.flipped.any() and not self.flipped.all())


@dataclass(frozen=True)
class Site:
    """Place of measurement as the file states it."""

    latitude: float
    height: float
    gravity: float | None


@dataclass(frozen=True)
class StandSigma:
    """Stated one-sigma errors, rad."""

    theta_x: float
    theta_y: float
    alpha: float
    beta: float


@dataclass(frozen=True)
class Stand:
    """The stand as the file states it."""

    id: str
    alpha: float
    chi: float
    sigma: StandSigma


@dataclass(frozen=True, eq=False)
class Noise:
    """One-sigma noise at the input, (m,) each."""

    reading: Array
    repeatability: Array
    stated: bool = True
    """Whether the file states the standard error of the readings."""


@dataclass(frozen=True, eq=False)
class Session:
    """One session as it is believed to be: the truth differs by stand errors, noise and effects."""

    unit: Unit
    schedule: Schedule
    site: Site
    stand: Stand
    mounting: Array
    noise: Noise
    started_at: str = "2026-03-01T09:00:00Z"
    count_time: float | None = None
    """s; gyros are then read as whole pulses."""


@dataclass(frozen=True)
class Effect:
    """One hidden effect. ``amplitude`` in the catalogue's order and SI units; ``shape`` what is not an amplitude."""

    cause: str
    amplitude: tuple[float, ...] = ()
    sensors: tuple[int, ...] = ()
    shape: tuple[float, ...] = field(default=())

    @property
    def sensor(self) -> int:
        """The only sensor."""
        return self.sensors[0]

    @property
    def k(self) -> float:
        """The only amplitude."""
        return self.amplitude[0]
