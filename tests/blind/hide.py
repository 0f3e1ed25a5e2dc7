"""An effect of a wanted strength in a session: its shape is drawn, its amplitude is found."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from tests.blind.catalogue import CATALOGUE, DISCRETE, HISTORY, SENSOR
from tests.blind.effects_grammar import GRAMMAR
from tests.blind.effects_outside import OUTSIDE_INPUT
from tests.blind.effects_sensor import late, smooth
from tests.blind.physics import mean_readings
from tests.blind.pose import believed
from tests.blind.rivals import shapes, step_of
from tests.blind.strength import Lens
from tests.blind.world import Array, Effect, Session

LARGEST_TURN = 0.02
LARGEST_ADDED = 0.1
LARGEST_ENTRY = 0.3
COARSE = 0.08


class UnhideableError(Exception):
    """This session cannot hold the effect at the wanted strength with a sensible amplitude."""


def signature(session: Session, effect: Effect, others: tuple[Effect, ...] = ()) -> Array:
    """(R, m) change of the readings by the effect, reading units."""
    return mean_readings(session, [*others, effect]) - mean_readings(session, others)


def draw_effect(session: Session, cause: str, rng: np.random.Generator) -> Effect:
    """The effect with a small amplitude in a random direction, on a random sensor."""
    if cause in DISCRETE:
        return _draw_record(session, cause, rng)
    hidden = CATALOGUE[cause]
    if cause == "temperature-rate" and not resolved(session):
        raise UnhideableError(cause)
    sensors = _draw_sensor(session, cause, rng) if hidden.scope == SENSOR or cause in SINGLE else ()
    direction = rng.normal(size=hidden.size)
    if cause == "sensor-drift":
        direction *= [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 1)][rng.integers(3)]
    steps = np.array([step_of(session, cause, k) for k in range(hidden.size)])
    shape = _draw_shape(session, cause, rng)
    if cause == "thermal-lag" and not followed(session, *shape):
        raise UnhideableError(cause)
    return Effect(cause, tuple(direction * steps), sensors, shape)


def followed(session: Session, tau: float) -> bool:
    """Whether the rows sample the temperature so closely that what lags behind it by τ, s, can be told from them."""
    schedule = session.schedule
    true = late(schedule, tau, smooth(schedule))
    sampled = late(schedule, tau, lambda t: np.interp(t, schedule.time, schedule.temperature))
    return bool(np.std(sampled - true) < COARSE * np.std(true - schedule.temperature))


def resolved(session: Session) -> bool:
    """Whether the rows sample the temperature so closely that its rate can be told from them."""
    schedule = session.schedule
    sampled = np.gradient(schedule.temperature, schedule.time)
    return bool(np.std(sampled - schedule.temperature_rate) < COARSE * np.std(schedule.temperature_rate))


SINGLE = ("sensor-drift", "g-sensitivity")


def _draw_sensor(session: Session, cause: str, rng: np.random.Generator) -> tuple[int, ...]:
    able = np.arange(session.unit.size)
    if cause in ("g-sensitivity", "vibration-rectification"):
        able = np.flatnonzero(session.unit.gyro == (cause == "g-sensitivity"))
    return (int(rng.choice(able)),)


def _draw_shape(session: Session, cause: str, rng: np.random.Generator) -> tuple[float, ...]:
    if cause in ("warm-up", "thermal-lag"):
        return (float(session.schedule.time[-1] * np.exp(rng.uniform(np.log(0.05), np.log(1.0)))),)
    if cause == "saturation":
        return (float(rng.choice([-1.0, 0.0, 1.0])),)
    grid = shapes(session, cause)
    return grid[rng.integers(len(grid))]


def _draw_record(session: Session, cause: str, rng: np.random.Generator) -> Effect:
    unit, R = session.unit, session.schedule.rows
    if cause == "positions-swapped":
        rows = rng.choice(R, 2, replace=False)
        if rng.random() < 0.5:
            first = int(rng.integers(R - 1))
            rows = np.array([first, first + 1])
        return Effect(cause, shape=tuple(float(j) for j in np.sort(rows)))
    if cause == "sign-reversed":
        return Effect(cause, sensors=(int(rng.integers(unit.size)),))
    if cause == "channels-swapped":
        kind = np.flatnonzero(unit.gyro == rng.choice(unit.gyro))
        i, k = sorted(int(j) for j in rng.choice(kind, 2, replace=False))
        return Effect(cause, sensors=(i, k))
    return Effect(cause)


def at_strength(lens: Lens, effect: Effect, target: float) -> tuple[Effect, float]:
    """The effect scaled to the target strength, and the strength that it reaches."""
    if effect.cause in DISCRETE:
        return effect, strength_of(lens, effect)
    if effect.cause == "saturation":
        return _clipped_to(lens, effect, target)
    if effect.cause == "excess-noise":
        unit_sigma = float(lens.session.noise.reading[effect.sensor])
        factor = _crossing(lambda f: lens.noise_strength(effect.sensor, f * unit_sigma) - target, 1e-2, 1e3)
        return replace(effect, amplitude=(factor * unit_sigma,)), target
    return scaled(effect, lens.session, lambda e: strength_of(lens, e), target)


def scaled(
    effect: Effect, session: Session, measured: Callable[[Effect], float], target: float
) -> tuple[Effect, float]:
    """Amplitude by repeated proportion."""
    for _ in range(4):
        now = measured(effect)
        if not now > 0:
            raise UnhideableError(effect.cause)
        effect = replace(effect, amplitude=tuple(k * target / now for k in effect.amplitude))
        if not sensible(session, effect):
            raise UnhideableError(effect.cause)
    return effect, measured(effect)


def strength_of(lens: Lens, effect: Effect) -> float:
    """Rule 2's strength."""
    if effect.cause == "excess-noise":
        return lens.noise_strength(effect.sensor, effect.k)
    return lens.strength(signature(lens.session, effect))


def _clipped_to(lens: Lens, effect: Effect, target: float) -> tuple[Effect, float]:
    u = mean_readings(lens.session)[:, effect.sensor]
    side = effect.shape[0]
    extreme = float(np.abs(u).max() if side == 0 else (side * u).max())
    if extreme <= 0:
        raise UnhideableError(effect.cause)

    def clip(depth: float) -> Effect:
        return replace(effect, amplitude=(extreme * (1 - depth),))

    depth = _crossing(lambda d: strength_of(lens, clip(d)) - target, 1e-9, 0.3)
    return clip(depth), target


def _crossing(excess: Callable[[float], float], low: float, high: float) -> float:
    """Point at which a growing function crosses zero, searched on a logarithmic scale."""
    if excess(low) > 0 or excess(high) < 0:
        raise UnhideableError
    return float(np.exp(brentq(lambda x: excess(np.exp(x)), np.log(low), np.log(high), xtol=1e-4)))


def sensible(session: Session, effect: Effect) -> bool:
    """Whether the amplitude is one that a real unit, stand or typist could show."""
    hidden = CATALOGUE.get(effect.cause)
    if effect.cause in (OUTSIDE_INPUT | GRAMMAR) or (hidden and (hidden.scope == SENSOR or effect.cause in SINGLE)):
        unit = session.unit
        i = effect.sensor
        change = signature(session, effect)[:, i] / unit.scale[i]
        size = np.abs(mean_readings(session)[:, i] / unit.scale[i] - unit.bias[i]).max()
        return bool(np.abs(change).max() < LARGEST_ADDED * size)
    if hidden and hidden.scope == HISTORY:
        return bool(np.abs(effect.amplitude).max() < LARGEST_ENTRY)
    if effect.cause == "stand-drift":
        return bool(abs(effect.k) * np.ptp(session.schedule.time) < LARGEST_TURN)
    if effect.cause == "alpha-entry":
        return bool(abs(believed(session).alpha[0] + effect.k - np.pi / 4) < np.pi / 6)
    return bool(np.abs(effect.amplitude).max() < LARGEST_TURN)
