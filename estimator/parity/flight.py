"""A flight to try parity on: manoeuvres, vibration and noise of known size; the truth is the caller's.

Body axes: x forward, y right, z down the lift, so that the specific force of level flight is g along z. Roll φ and
pitch ϑ move smoothly from one manoeuvre to the next; load n is along the lift:

    f = g·(sin ϑ, n_y + k·sin φ, n·cos ϑ·(1 − k + k·cos φ))       k = 0 in coordinated flight, 1 in a slow roll

In coordinated flight the lift stays along z however steep the turn: a transport shows its sensors little of y.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import lfilter

from estimator.applied_vector import gravity
from estimator.forward import response
from estimator.parameters import SensorParameters
from estimator.session import IN_SERVICE, Array, CalibrationSession, Sensor, Site

SMOOTH = 2.0
"""s from one manoeuvre to the next: what a pilot takes."""


@dataclass(frozen=True)
class Manoeuvre:
    """A manoeuvre and its duration."""

    seconds: float
    roll: float = 0.0
    """Angle turned through in all, rad; a bank angle in coordinated flight."""
    pitch: float = 0.0
    """rad"""
    load: float = 1.0
    """Load along the lift, in g."""
    side: float = 0.0
    """Sideways load, in g."""
    slow_roll: bool = False
    """Whether the block is turned through the roll; otherwise a turn is coordinated."""


CRUISE = Manoeuvre(20.0)
"""Straight and level."""
TRANSPORT = (
    CRUISE,
    Manoeuvre(15.0, pitch=0.2),
    Manoeuvre(20.0, load=1.3),
    Manoeuvre(10.0, side=0.08),
    Manoeuvre(15.0, pitch=-0.12, load=0.9),
    Manoeuvre(10.0, side=-0.08),
)
"""Climb, turn, slip, descent: what passengers bear."""
AEROBATIC = (
    CRUISE,
    Manoeuvre(10.0, pitch=0.9, load=1.6),
    Manoeuvre(12.0, roll=2 * np.pi, slow_roll=True),
    Manoeuvre(10.0, pitch=-0.8, load=0.6),
    Manoeuvre(8.0, load=3.0),
    Manoeuvre(12.0, roll=-2 * np.pi, slow_roll=True, pitch=0.3),
)
"""Steep climb, slow rolls, a dive and its recovery: turns the specific force through the whole sphere."""


@dataclass(frozen=True)
class Weather:
    """Noise and vibration, one sigma."""

    noise: float = 1e-3
    """White, each sensor its own, m/s² a sample."""
    wander: float = 0.0
    """Wander of each sensor's zero, first-order Gauss–Markov, m/s²."""
    wander_time: float = 100.0
    """s"""
    vibration: float = 0.5
    """Common to all sensors, along each body axis, m/s²."""


def profile(manoeuvres: Sequence[Manoeuvre], seconds: float, rate: float, g: float) -> Array:
    """(R, 3) specific force of the manoeuvres, repeated for as long as asked, m/s²."""
    count = int(seconds * rate)
    columns: list[Array] = []
    while sum(map(len, columns)) < count:
        columns.extend(course_of(m, rate) for m in manoeuvres)
    phi, theta, load, side, slow = np.concatenate(columns)[:count].T
    theta, load, side, slow = (
        uniform_filter1d(x, max(int(SMOOTH * rate), 1), mode="nearest") for x in (theta, load, side, slow)
    )
    y = side + slow * np.sin(phi)
    z = load * np.cos(theta) * (1 - slow + slow * np.cos(phi))
    return g * np.column_stack([np.sin(theta), y, z])


def course_of(m: Manoeuvre, rate: float) -> Array:
    """(R, 5) roll and pitch, rad, load and side load, g, and whether it is a slow roll (1 or 0), of one manoeuvre."""
    count = int(m.seconds * rate)
    roll = m.roll * np.arange(count) / count if m.slow_roll else np.full(count, m.roll)
    level = np.full((count, 4), [m.pitch, m.load, m.side, float(m.slow_roll)])
    return np.column_stack([roll, level])


def vibration(sigma: float, count: int, rate: float, rng: np.random.Generator) -> Array:
    """(R, 3) m/s²: half a rotor's two harmonics, half broad band."""
    t = np.arange(count) / rate
    phases = rng.uniform(0, 2 * np.pi, (2, 3))
    rotor = sum(np.sin(2 * np.pi * 0.17 * rate * k * t[:, None] + phases[k - 1]) for k in (1, 2))
    return sigma * (np.sqrt(0.25) * rotor + np.sqrt(0.5) * rng.standard_normal((count, 3)))


def wander(weather: Weather, shape: tuple[int, int], rate: float, rng: np.random.Generator) -> Array:
    """(R, m) first-order Gauss–Markov process of each sensor, m/s²."""
    keep = float(np.exp(-1.0 / (rate * weather.wander_time)))
    steps = weather.wander * np.sqrt(1 - keep**2) * rng.standard_normal(shape)
    steps[0] = weather.wander * rng.standard_normal(shape[1])
    return np.asarray(lfilter([1.0], [1.0, -keep], steps, axis=0))


def fly(
    sensors: tuple[Sensor, ...],
    truth: SensorParameters,
    rng: np.random.Generator,
    *,
    manoeuvres: Sequence[Manoeuvre] = AEROBATIC,
    seconds: float = 300.0,
    rate: float = 20.0,
    weather: Weather | None = None,
    site: Site | None = None,
    unit_name: str = "simulated",
) -> CalibrationSession:
    """A raw recording in service; ``truth`` holds the sensors as they are now, (m,), all in one point."""
    place, w = site or Site(gravity=9.81), weather or Weather()
    force = profile(manoeuvres, seconds, rate, gravity(place))
    shape = (len(force), len(sensors))
    force = force + vibration(w.vibration, len(force), rate, rng)
    noise = w.noise * rng.standard_normal(shape) + wander(w, shape, rate, rng)
    clean = response(truth, np.repeat(force[:, None], len(sensors), axis=1))
    offset = np.array([s.nominal_offset or 0.0 for s in sensors])
    return CalibrationSession(
        unit=unit_name,
        block=sensors[0].kind,
        programme=IN_SERVICE,
        sensors=tuple(replace(s, position=np.zeros(3)) for s in sensors),
        readings=clean + truth.scale * noise + offset,
        standard_errors=np.full(shape, np.nan),
        site=place,
        sample_rate=rate,
    )
