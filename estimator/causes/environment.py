"""Causes that follow time and temperature. A bar means the session's mean."""

from collections.abc import Iterator, Sequence

import numpy as np

from estimator.causes.contract import GridCause, SensorCause, Setting, Shape, column
from estimator.causes.sensor import across
from estimator.session import Array


def elapsed(setting: Setting) -> Array:
    """(R,) t − t̄, s."""
    assert setting.time is not None
    return setting.time - setting.time.mean()


def since_on(setting: Setting) -> Array:
    """(R,) t, s since switching on; where that is not known by the session's clock, or, where the clock reads less than
    0, from the first moment that it reads."""
    assert setting.time is not None
    on = min(float(setting.time.min()), 0.0) if setting.switched_on is None else setting.switched_on
    return setting.time - on


def warmth(setting: Setting) -> Array:
    """(R,) T − T̄, °C."""
    assert setting.temperature is not None
    return setting.temperature - setting.temperature.mean()


class BiasTemperature(SensorCause):
    identifier = "bias-temperature"
    scope = "environment"
    lasts = True
    equation = "k·(T − T̄)"
    units = ("m/s²/K",)
    needs = frozenset({"temperature"})
    alike = True
    sentence = "The bias of {sensors} depends on temperature."
    advice = "Model the temperature coefficient of the bias, or hold the temperature during the session."
    shared_sentence = "The biases of {sensors} depend on temperature in common."
    shared_advice = "Model the temperature coefficients of these biases, or hold the temperature during the session."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) T − T̄, °C."""
        return column(warmth(setting))


class BiasTemperatureCurve(SensorCause):
    """A line, which is simpler, is named where the bend does not show."""

    identifier = "bias-temperature-curve"
    scope = "environment"
    lasts = True
    equation = "k1·(T − T̄) + k2·(T − T̄)²"
    units = ("m/s²/K", "m/s²/K²")
    needs = frozenset({"temperature"})
    contains = frozenset({"bias-temperature"})
    alike = True
    sentence = "The bias of {sensors} depends on temperature along a curve."
    advice = "Model the bias as a parabola over temperature, or hold the temperature during the session."
    fewest = 4
    """Different temperatures: a parabola goes through any three."""

    def available(self, setting: Setting) -> bool:
        return (
            super().available(setting)
            and setting.temperature is not None
            and len(np.unique(setting.temperature)) >= self.fewest
        )

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 2) T − T̄, °C, and its square, °C²."""
        return column(warmth(setting), warmth(setting) ** 2)


class ScaleTemperature(SensorCause):
    identifier = "scale-temperature"
    scope = "environment"
    lasts = True
    equation = "k·(T − T̄)·a"
    units = ("1/K",)
    needs = frozenset({"temperature"})
    sentence = "The scale factor of {sensors} depends on temperature."
    advice = "Model the temperature coefficient of the scale factor, or hold the temperature during the session."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) (T − T̄)·a, °C·m/s²."""
        return column(warmth(setting) * setting.a[:, i])


class ScaleTemperatureCurve(BiasTemperatureCurve):
    """Likewise."""

    identifier = "scale-temperature-curve"
    lasts = True
    equation = "(k1·(T − T̄) + k2·(T − T̄)²)·a"
    units = ("1/K", "1/K²")
    contains = frozenset({"scale-temperature"})
    alike = False
    sentence = "The scale factor of {sensors} depends on temperature along a curve."
    advice = "Model the scale factor as a parabola over temperature, or hold the temperature during the session."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 2) (T − T̄)·a, °C·m/s², and (T − T̄)²·a, °C²·m/s²."""
        return super().term(setting, i, nonlinear) * setting.a[:, i, None]


class TemperatureRate(SensorCause):
    identifier = "temperature-rate"
    scope = "environment"
    equation = "k·dT/dt"
    units = ("m/s²/(K/s)",)
    needs = frozenset({"temperature", "time"})
    alike = True
    sentence = "The bias of {sensors} depends on the rate of temperature change."
    advice = "Let the unit soak until its temperature is stable before measuring; shield it from draughts."
    shared_sentence = "The biases of {sensors} depend in common on the rate of temperature change."
    shared_advice = "Let the unit soak until its temperature is stable before measuring; shield it from draughts."

    def available(self, setting: Setting) -> bool:
        return super().available(setting) and setting.time is not None and bool(np.all(np.diff(setting.time) > 0))

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) dT/dt, °C/s, by differences of neighbouring rows."""
        assert setting.temperature is not None
        assert setting.time is not None
        return column(np.gradient(setting.temperature, setting.time))


class BiasRamp(SensorCause):
    identifier = "bias-ramp"
    scope = "environment"
    equation = "k·(t − t̄)"
    units = ("m/s²/s",)
    needs = frozenset({"time"})
    alike = True
    sentence = "The bias of {sensors} drifts steadily during the session."
    advice = "Repeat the first position at the end; let the unit warm up longer; watch this sensor."
    shared_sentence = "The biases of {sensors} drift together and steadily during the session."
    shared_advice = "Repeat the first position at the end; let the unit warm up longer, or record its temperature."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) t − t̄, s."""
        return column(elapsed(setting))


class ScaleRamp(SensorCause):
    identifier = "scale-ramp"
    scope = "environment"
    equation = "k·(t − t̄)·a"
    units = ("1/s",)
    needs = frozenset({"time"})
    sentence = "The scale factor of {sensors} drifts steadily during the session."
    advice = "Let the unit warm up longer; check the voltage reference and the loop current of this sensor."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) (t − t̄)·a, m/s."""
        return column(elapsed(setting) * setting.a[:, i])


class AxisCreep(SensorCause):
    identifier = "axis-creep"
    scope = "environment"
    equation = "(k1·(p·n) + k2·(o·n))·(t − t̄)"
    units = ("rad/s", "rad/s")
    needs = frozenset({"time"})
    grows_an_angle = True
    sentence = "The input axis of {sensors} turns slowly during the session."
    advice = "Check the sensor's fastening and adhesive; repeat after a thermal soak."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 2) (p·n)·(t − t̄) and (o·n)·(t − t̄), m/s."""
        p, o = across(setting, i)
        return column(p * elapsed(setting), o * elapsed(setting))


SETTLED = 7.0
"""Time constants after which a warm-up is over: a thousandth of it is left, of a whole mg 1 µg."""


def settled(setting: Setting) -> float:
    """s: time constants up to this one are over before the first row; 0 where nobody knows when it was switched on."""
    assert setting.time is not None
    return 0.0 if setting.switched_on is None else float(setting.time[0] - setting.switched_on) / SETTLED


class WarmUp(GridCause):
    """The nonlinear parameter is τ, s. The amplitude is that at switching on, where the session says when that was."""

    identifier = "warm-up"
    scope = "environment"
    equation = "k·exp(−t/τ), τ free"
    units = ("m/s²",)
    needs = frozenset({"time"})
    nonlinear_units = ("s",)
    shape_words = "time constant"
    alike = True
    sentence = "The bias of {sensors} settles after switch-on."
    advice = "Switch the unit on earlier and wait for several time constants before the first position."
    shared_sentence = "The biases of {sensors} settle together after switch-on."
    shared_advice = "Switch the unit on earlier and wait for three time constants, or record its temperature."
    since_power_on = True
    lacking = "the time soon after switching on"
    steps = 10

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        """Time constants from the rows' spacing to the span; no τ that is over before the first row."""
        assert setting.time is not None
        span = float(np.ptp(setting.time))
        shortest = max(span / max(setting.rows, 2), settled(setting))
        if not 0 < shortest <= span:
            return
        for tau in np.geomspace(shortest, span, self.steps):
            yield (float(tau),)

    def terms(self, setting: Setting, i: int, grid: Sequence[tuple[float, ...]]) -> Array:
        """(S, R, 1) exp(−t/τ), dimensionless; 0 of a τ that is over long before the first row."""
        tau = np.array(grid)
        return column(np.where(tau < settled(setting) / 2, 0.0, np.exp(-since_on(setting) / tau)))

    def left(self, setting: Setting, nonlinear: tuple[float, ...]) -> float:
        """exp(−t/τ) at the first row after switching on, dimensionless; 1 where nobody knows when that was."""
        return float(np.exp(-SETTLED * settled(setting) / nonlinear[0]))

    def neighbours(self, setting: Setting, shape: Shape) -> Iterator[Shape]:
        (tau,) = shape.nonlinear
        for factor in np.geomspace(0.6, 1.7, 23):
            columns = np.zeros_like(shape.columns)
            columns[:, shape.sensors[0], :1] = self.term(setting, shape.sensors[0], (tau * factor,))
            yield Shape(shape.sensors, columns, (float(tau * factor),))


class BiasJump(GridCause):
    """The nonlinear parameter is the first row after the jump, counted from 0."""

    identifier = "bias-jump"
    scope = "environment"
    equation = "k from position j0 on, j0 free"
    units = ("m/s²",)
    nonlinear_units = ("row",)
    shape_words = "from"
    sentence = "The bias of {sensors} has one step."
    advice = "Find out what happened then: a shock, a change of supply, a particle in the sensor. Repeat the session."
    shared_sentence = "The biases of {sensors} have one step at the same moment."
    shared_advice = (
        "Find out what happened to the whole block then: a shock, an interruption of its supply. Repeat the session."
    )

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        for row in range(1, setting.rows):
            yield (float(row),)

    def terms(self, setting: Setting, i: int, grid: Sequence[tuple[float, ...]]) -> Array:
        """(S, R, 1) 0 before the jump, 1 from it on, dimensionless."""
        return column((np.arange(setting.rows) >= np.array(grid)).astype(float))
