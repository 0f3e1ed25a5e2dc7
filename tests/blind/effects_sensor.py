"""Causes inside one sensor: what is added at its input, what changes its parameters, what clips its readings.

Every function takes the session, the effect, n (R, 3) and a (R,) of that sensor, m/s² or rad/s, and the specific force
(R, 3), m/s², and returns what is added inside the bracket of the sensor model, (R,) m/s² or rad/s. p and o are the two
unit vectors across the axis, t the time, T the temperature, k the amplitudes.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from tests.blind.world import Array, Effect, Schedule, Session, Unit

Course = Callable[[Array], Array]


FOLLOWED = 400.0
"""s; the longest steps in which a lag is followed are an eighth of this: short beside the rows."""


def across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors (3,), dimensionless, orthogonal to an axis (3,) and to one another."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    p = np.cross(axis, helper)
    p /= np.linalg.norm(p)
    return p, np.cross(axis, p)


def sideways(session: Session, effect: Effect, n: Array) -> tuple[Array, Array]:
    """(R,) p·n and (R,) o·n of n (R, 3), m/s² or rad/s."""
    p, o = across(session.unit.axis[effect.sensor])
    return n @ p, n @ o


def centred(values: Array) -> Array:
    """(R,) without the session mean, in its own unit, s or °C."""
    return values - values.mean()


def cubic_nonlinearity(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·a³."""
    return effect.k * a**3


def scale_asymmetry(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·|a|."""
    return effect.k * np.abs(a)


def cross_coupling(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: a·(k₁ p·n + k₂ o·n)."""
    pn, on = sideways(session, effect, n)
    return a * (effect.amplitude[0] * pn + effect.amplitude[1] * on)


def bias_temperature(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·(T − mean T)."""
    return effect.k * centred(session.schedule.temperature)


def bias_temperature_curve(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: a parabola over T whose slope and bend are given about the mean T."""
    T = session.schedule.temperature
    about = T.mean()
    straight, bent = effect.amplitude
    at = np.array([about - 1.0, about, about + 1.0])
    through = np.array([bent - straight, 0.0, bent + straight])
    return sum(y * np.prod([(T - u) / (x - u) for u in at if u != x], axis=0) for x, y in zip(at, through, strict=True))


def scale_temperature_curve(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: the same parabola of the scale factor."""
    return bias_temperature_curve(session, effect, n, a, force) * a


def scale_temperature(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·(T − mean T)·a."""
    return effect.k * centred(session.schedule.temperature) * a


def bias_ramp(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·(t − mean t)."""
    return effect.k * centred(session.schedule.time)


def warm_up(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·exp(−t/τ)."""
    return effect.k * np.exp(-session.schedule.time / effect.shape[0])


def bias_jump(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k from a row on."""
    return effect.k * (np.arange(len(a)) >= effect.shape[0])


def hysteresis(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·sign of the way that a came from, 0 in the first row of a run."""
    flipped = session.schedule.flipped
    came_from = np.sign(np.diff(a, prepend=a[0]))
    first = np.concatenate([[True], flipped[1:] != flipped[:-1]])
    return effect.k * np.where(first, 0.0, came_from)


def odd_quadratic(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·a·|a|."""
    return effect.k * a * np.abs(a)


def bias_asymmetry(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·sign a."""
    return effect.k * np.sign(a)


def cross_axis_quadratic(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k₁ (p·n)² + k₂ (p·n)(o·n)."""
    pn, on = sideways(session, effect, n)
    return effect.amplitude[0] * pn**2 + effect.amplitude[1] * pn * on


def scale_ramp(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·(t − mean t)·a."""
    return effect.k * centred(session.schedule.time) * a


def axis_creep(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: (k₁ p·n + k₂ o·n)·(t − mean t)."""
    pn, on = sideways(session, effect, n)
    return (effect.amplitude[0] * pn + effect.amplitude[1] * on) * centred(session.schedule.time)


def temperature_rate(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·dT/dt."""
    return effect.k * session.schedule.temperature_rate


def smooth(schedule: Schedule) -> Course:
    """The temperature, °C, at any times, s: through the rows with its true rate there."""
    return CubicHermiteSpline(schedule.time, schedule.temperature, schedule.temperature_rate)


def late(schedule: Schedule, tau: float, course: Course) -> Array:
    """(R,) L, °C: τ·dL/dt = T − L, L = T at the first row, by implicit midpoint steps short beside τ and the rows."""
    ends = np.unique(np.concatenate([schedule.time, np.arange(0.0, schedule.time[-1], min(tau, FOLLOWED) / 8)]))
    driven, step = course((ends[1:] + ends[:-1]) / 2), np.diff(ends) / (2 * tau)
    found = [float(schedule.temperature[0])]
    for warm, s in zip(driven.tolist(), step.tolist(), strict=True):
        found.append((found[-1] * (1 - s) + 2 * s * warm) / (1 + s))
    return np.array(found)[np.searchsorted(ends, schedule.time)]


def thermal_lag(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·(L − mean L), the temperature that a body with a time constant takes on."""
    return effect.k * centred(late(session.schedule, effect.shape[0], smooth(session.schedule)))


def vibration_rectification(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s²: k·w², averaged over the phases of a shake w of the row's rms; less the mean over the rows."""
    assert session.schedule.vibration is not None
    phase = 2 * np.pi * np.arange(16) / 16
    shake = np.sqrt(2) * session.schedule.vibration[:, None] * np.sin(phase)
    return effect.k * centred((shake**2).mean(axis=1))


def bias_per_position(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k₁ sin β + k₂ cos β."""
    beta = session.schedule.beta
    return effect.amplitude[0] * np.sin(beta) + effect.amplitude[1] * np.cos(beta)


def reading_outlier(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k in one row."""
    return effect.k * (np.arange(len(a)) == effect.shape[0])


def g_sensitivity(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·(specific force)."""
    return force @ np.array(effect.amplitude)


INPUT = {
    "cubic-nonlinearity": cubic_nonlinearity,
    "scale-asymmetry": scale_asymmetry,
    "cross-coupling": cross_coupling,
    "bias-temperature": bias_temperature,
    "bias-temperature-curve": bias_temperature_curve,
    "scale-temperature-curve": scale_temperature_curve,
    "scale-temperature": scale_temperature,
    "bias-ramp": bias_ramp,
    "warm-up": warm_up,
    "bias-jump": bias_jump,
    "hysteresis": hysteresis,
    "odd-quadratic": odd_quadratic,
    "bias-asymmetry": bias_asymmetry,
    "cross-axis-quadratic": cross_axis_quadratic,
    "scale-ramp": scale_ramp,
    "axis-creep": axis_creep,
    "temperature-rate": temperature_rate,
    "thermal-lag": thermal_lag,
    "vibration-rectification": vibration_rectification,
    "bias-per-position": bias_per_position,
    "reading-outlier": reading_outlier,
    "g-sensitivity": g_sensitivity,
}


def sensor_drift(unit: Unit, effect: Effect) -> Unit:
    """Amplitude: relative scale, bias, and two turns of the axis."""
    i = effect.sensor
    scale, bias, turn_p, turn_o = effect.amplitude
    p, o = across(unit.axis[i])
    axis = unit.axis[i] + turn_p * p + turn_o * o
    moved = {"scale": unit.scale.copy(), "bias": unit.bias.copy(), "axis": unit.axis.copy()}
    moved["scale"][i] *= 1 + scale
    moved["bias"][i] += bias
    moved["axis"][i] = axis / np.linalg.norm(axis)
    return replace(unit, **moved)


UNIT = {"sensor-drift": sensor_drift}


def clipped(u: Array, effects: Sequence[Effect]) -> Array:
    """Readings (R, m), reading units, cut to a limit. The effect's shape: the side, +1 or −1, or 0 for both."""
    u = u.copy()
    for effect in effects:
        if effect.cause == "saturation":
            i, limit, side = effect.sensor, effect.k, effect.shape[0]
            u[:, i] = np.clip(u[:, i], -np.inf if side > 0 else -abs(limit), np.inf if side < 0 else abs(limit))
    return u
