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
    """(R,) t, s; where the clock reads less than 0, counted from the first moment that it reads."""
    assert setting.time is not None
    return setting.time - min(float(setting.time.min()), 0.0)


def warmth(setting: Setting) -> Array:
    """(R,) T − T̄, °C."""
    assert setting.temperature is not None
    return setting.temperature - setting.temperature.mean()


class BiasTemperature(SensorCause):
    identifier = "bias-temperature"
    scope = "environment"
    equation = "k·(T − T̄)"
    units = ("m/s²/K",)
    needs = frozenset({"temperature"})
    alike = True
    sentence = "The zero of {sensors} follows the temperature."
    advice = "Model the temperature coefficient of the bias, or hold the temperature during the session."
    shared_sentence = "The zeros of {sensors} follow the temperature together."
    shared_advice = "Model the temperature coefficients of these biases, or hold the temperature during the session."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) T − T̄, °C."""
        return column(warmth(setting))


class BiasTemperatureCurve(SensorCause):
    """A line, which is simpler, is named where the bend does not show."""

    identifier = "bias-temperature-curve"
    scope = "environment"
    equation = "k1·(T − T̄) + k2·(T − T̄)²"
    units = ("m/s²/K", "m/s²/K²")
    needs = frozenset({"temperature"})
    contains = frozenset({"bias-temperature"})
    alike = True
    sentence = "The zero of {sensors} follows the temperature along a curve."
    advice = "Model the zero by a parabola over the temperature, or hold the temperature during the session."
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
    equation = "k·(T − T̄)·a"
    units = ("1/K",)
    needs = frozenset({"temperature"})
    sentence = "The scale factor of {sensors} follows the temperature."
    advice = "Model the temperature coefficient of the scale factor, or hold the temperature during the session."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) (T − T̄)·a, °C·m/s²."""
        return column(warmth(setting) * setting.a[:, i])


class TemperatureRate(SensorCause):
    identifier = "temperature-rate"
    scope = "environment"
    equation = "k·dT/dt"
    units = ("m/s²/(K/s)",)
    needs = frozenset({"temperature", "time"})
    alike = True
    sentence = "The zero of {sensors} follows how fast the temperature changes."
    advice = "Let the unit soak until the temperature stands still before measuring; shield it from draughts."
    shared_sentence = "The zeros of {sensors} follow together how fast the temperature changes."
    shared_advice = "Let the unit soak until the temperature stands still before measuring; shield it from draughts."

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
    sentence = "The zero of {sensors} drifts steadily through the session."
    advice = "Repeat the first position at the end; let the unit warm up longer; watch this sensor."
    shared_sentence = "The zeros of {sensors} drift together, steadily through the session."
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
    sentence = "The scale factor of {sensors} drifts steadily through the session."
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
    sentence = "The input axis of {sensors} turns slowly through the session."
    advice = "Check the sensor's fastening and adhesive; repeat after a thermal soak."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 2) (p·n)·(t − t̄) and (o·n)·(t − t̄), m/s."""
        p, o = across(setting, i)
        return column(p * elapsed(setting), o * elapsed(setting))


class WarmUp(GridCause):
    """The nonlinear parameter is τ, s."""

    identifier = "warm-up"
    scope = "environment"
    equation = "k·exp(−t/τ), τ free"
    units = ("m/s²",)
    needs = frozenset({"time"})
    nonlinear_units = ("s",)
    shape_words = "time constant"
    alike = True
    sentence = "The zero of {sensors} settles after switching on."
    advice = "Switch the unit on earlier and wait for several time constants before the first position."
    shared_sentence = "The zeros of {sensors} settle together after switching on."
    shared_advice = "Switch the unit on earlier and wait for three time constants, or record its temperature."
    steps = 10

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        assert setting.time is not None
        span = float(np.ptp(setting.time))
        if span <= 0:
            return
        for tau in np.geomspace(span / max(setting.rows, 2), span, self.steps):
            yield (float(tau),)

    def terms(self, setting: Setting, i: int, grid: Sequence[tuple[float, ...]]) -> Array:
        """(S, R, 1) exp(−t/τ), dimensionless."""
        return column(np.exp(-since_on(setting) / np.array(grid)))

    def neighbours(self, setting: Setting, shape: Shape) -> Iterator[Shape]:
        (tau,) = shape.nonlinear
        for factor in np.geomspace(0.6, 1.7, 23):
            columns = np.zeros_like(shape.columns)
            columns[:, shape.sensors[0], :1] = self.term(setting, shape.sensors[0], (tau * factor,))
            yield Shape(shape.sensors, columns, (float(tau * factor),))

    def derivative(self, setting: Setting, shape: Shape) -> Array:
        """(R, m, 1) by ln τ, dimensionless."""
        (tau,), time = shape.nonlinear, since_on(setting)
        bent = np.zeros((*shape.columns.shape[:2], 1))
        bent[:, shape.sensors[0], 0] = np.exp(-time / tau) * time / tau
        return bent


class BiasJump(GridCause):
    """The nonlinear parameter is the first row after the jump, counted from 0."""

    identifier = "bias-jump"
    scope = "environment"
    equation = "k from position j0 on, j0 free"
    units = ("m/s²",)
    nonlinear_units = ("row",)
    shape_words = "from"
    repeats = 2
    sentence = "The zero of {sensors} jumps once and stays."
    advice = "Look for what happened then: a shock, a supply switch, a particle in the sensor. Repeat the session."
    shared_sentence = "The zeros of {sensors} jump together, at one moment, and stay."
    shared_advice = "Look for what the whole block met then: a bump, a break of its supply. Repeat the session."

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        for row in range(1, setting.rows):
            yield (float(row),)

    def terms(self, setting: Setting, i: int, grid: Sequence[tuple[float, ...]]) -> Array:
        """(S, R, 1) 0 before the jump, 1 from it on, dimensionless."""
        return column((np.arange(setting.rows) >= np.array(grid)).astype(float))
