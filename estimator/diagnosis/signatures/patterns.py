"""Structure without a name: smooth patterns in β, order and temperature that no cause may explain.

They compete with the causes of the catalogue. Where one of them wins, the session holds something that the catalogue
does not: it is reported as unexplained, with where it lives, and never forced into a name.
"""

from collections.abc import Iterator

import numpy as np

from estimator.causes.contract import Setting, Shape, Signature
from estimator.causes.stand import harmonic
from estimator.forward import jacobian
from estimator.message import say
from estimator.session import Array

HIGHEST = 8
"""Harmonic of β up to which structure is looked for (half the positions of a run where those are fewer): what
the terms of baseline and catalogue make of β is small beyond the fifth."""

EVEN = 0.1
"""Share of a row's step by which rows may come early or late and still count as even: a wave of half as many periods
as rows is then off by a twentieth of its own period."""


def highest(setting: Setting) -> int:
    """Highest harmonic of β that the positions of one run resolve."""
    assert setting.beta is not None
    positions = len(np.unique(np.round(np.mod(setting.beta, 2 * np.pi), 6)))
    return min(HIGHEST, (positions - 1) // 2)


def on_each_sensor(setting: Setting, patterns: Array, label: tuple[float, ...]) -> Iterator[Shape]:
    """Patterns (R, q), m/s² (rad/s) per unit amplitude, placed on every sensor in turn."""
    m = len(setting.kinds)
    for i in range(m):
        columns = np.zeros((setting.rows, m, patterns.shape[1]))
        columns[:, i, :] = patterns
        yield Shape((i,), columns, label)


class Pattern(Signature):
    """A family of patterns; ``nonlinear`` of its shapes says which member."""

    scope = "unexplained"
    nameless = True
    equation = ""
    units = ()
    advice = "Look at the residuals there; no known cause has this pattern."
    description = ""
    """Description of the pattern in place of the sentence, for shapes whose parameter is 1."""

    def where(self, shape: Shape) -> str:
        """The place of the pattern, in words."""
        if self.description and shape.nonlinear == (1.0,):
            return self.description
        return say(self.sentence, **{str(k): f"{value:g}" for k, value in enumerate(shape.nonlinear)})


class SensorHarmonic(Pattern):
    identifier = "sensor-harmonic"
    needs = frozenset({"stand"})
    sentence = "harmonic {0} of β"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        for order in range(1, highest(setting) + 1):
            yield from on_each_sensor(setting, harmonic(setting, order), (float(order),))


class RunHarmonic(Pattern):
    identifier = "run-harmonic"
    needs = frozenset({"stand", "both runs"})
    sentence = "harmonic {0} of β, opposite in the two runs"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        assert setting.flipped is not None
        sign = np.where(setting.flipped, -1.0, 1.0)[:, None]
        for order in range(1, highest(setting) + 1):
            yield from on_each_sensor(setting, sign * harmonic(setting, order), (float(order),))


class HarmonicSeries(Pattern):
    identifier = "harmonic-series"
    needs = frozenset({"stand"})
    sentence = "several harmonics of β together"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        orders = range(2, highest(setting) + 1)
        if len(orders) >= 2:
            yield from on_each_sensor(setting, np.concatenate([harmonic(setting, k) for k in orders], axis=1), ())


class SensorPeriodic(Pattern):
    identifier = "sensor-periodic"
    sentence = "a wave of {0} periods over the session"
    description = "a wave of one period over the session"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        for place in places_in_session(setting):
            for periods in np.arange(2, setting.rows + 1) / 2:
                wave = 2 * np.pi * periods * place
                yield from on_each_sensor(setting, np.stack([np.sin(wave), np.cos(wave)], axis=-1), (float(periods),))


def places_in_session(setting: Setting) -> list[Array]:
    """(R,) relative place of every row in the session, by count and, where rows do not come evenly, by time."""
    count = np.arange(setting.rows) / setting.rows
    if setting.time is None or not np.ptp(setting.time) > 0:
        return [count]
    elapsed = (setting.time - setting.time[0]) / np.ptp(setting.time) * (1 - 1 / setting.rows)
    return [count] if np.abs(elapsed - count).max() < EVEN / setting.rows else [count, elapsed]


class SensorTrend(Pattern):
    identifier = "sensor-trend"
    sentence = "a smooth course over the session"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        if setting.rows >= 12:
            place = np.linspace(-1, 1, setting.rows)
            yield from on_each_sensor(setting, np.polynomial.legendre.legvander(place, 6)[:, 1:], ())


class TemperatureCurve(Pattern):
    identifier = "temperature-curve"
    needs = frozenset({"temperature"})
    sentence = "a curve over temperature"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        assert setting.temperature is not None
        t = setting.temperature
        if len(np.unique(t)) >= 6:
            scaled = 2 * (t - t.min()) / np.ptp(t) - 1
            yield from on_each_sensor(setting, np.polynomial.legendre.legvander(scaled, 4)[:, 1:], ())


class TemperatureWave(Pattern):
    identifier = "temperature-wave"
    needs = frozenset({"temperature"})
    sentence = "a wave of {0} half periods over the temperature's range"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        assert setting.temperature is not None
        t = setting.temperature
        place = np.pi * (t - t.min()) / np.ptp(t)
        for order in range(2, min(10, len(np.unique(t)) // 2) + 1):
            yield from on_each_sensor(
                setting, np.stack([np.sin(order * place), np.cos(order * place)], -1), (float(order),)
            )


class StepInTemperature(Pattern):
    identifier = "temperature-step"
    needs = frozenset({"temperature"})
    sentence = "a step at {0} °C"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        assert setting.temperature is not None
        levels = np.unique(setting.temperature)
        for threshold in (levels[1:] + levels[:-1]) / 2 if len(levels) <= 200 else ():
            yield from on_each_sensor(setting, (setting.temperature > threshold)[:, None] * 1.0, (float(threshold),))


class InputCurve(Pattern):
    identifier = "input-curve"
    sentence = "a curve over the sensor's own input"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        m = len(setting.kinds)
        for i in range(m):
            x = setting.a[:, i] / setting.norm[i]
            if len(np.unique(np.round(x, 3))) >= 9:
                columns = np.zeros((setting.rows, m, 5))
                columns[:, i, :] = np.polynomial.legendre.legvander(x, 7)[:, 3:]
                yield Shape((i,), columns)


class TurningScale(Pattern):
    identifier = "turning-scale"
    needs = frozenset({"stand"})
    sentence = "the scale factor, harmonic {0} of β"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        m = len(setting.kinds)
        for order in range(1, min(highest(setting), 3) + 1):
            for i in range(m):
                columns = np.zeros((setting.rows, m, 2))
                columns[:, i, :] = harmonic(setting, order) * setting.a[:, i, None]
                yield Shape((i,), columns, (float(order),))


class CommonHarmonic(Pattern):
    identifier = "common-harmonic"
    needs = frozenset({"stand"})
    sentence = "the applied vector, common to all sensors: harmonic {0} of β"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        assert setting.d_beta is not None
        assert setting.d_alpha is not None
        turned = [setting.through(turn[..., None]) for turn in (setting.d_beta, setting.d_alpha)]
        for order in range(1, highest(setting) + 1):
            both = harmonic(setting, order)[:, None, :]
            yield from (Shape((), columns * both, (float(order),)) for columns in turned)


class CommonPeriodic(Pattern):
    identifier = "common-periodic"
    needs = frozenset({"stand"})
    sentence = "the applied vector, common to all sensors: a wave of {0} periods over the session"
    description = "the applied vector, common to all sensors: a wave of one period over the session"

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        assert setting.d_beta is not None
        assert setting.d_alpha is not None
        place = np.arange(setting.rows) / setting.rows
        turned = [setting.through(turn[..., None]) for turn in (setting.d_beta, setting.d_alpha)]
        for periods in range(1, setting.rows // 2):
            wave = 2 * np.pi * periods * place
            both = np.stack([np.sin(wave), np.cos(wave)], axis=-1)[:, None, :]
            yield from (Shape((), columns * both, (float(periods),)) for columns in turned)


class OwnChange(Pattern):
    """A change of one sensor's parameters since the history: with the quadratic term or without, or of that alone."""

    identifier = "own-change"
    needs = frozenset({"history"})
    between = True
    sentence = "the sensor's parameters, changed since the earlier sessions"

    moves = ([0, 1, 3, 4], [2], [0, 1, 2, 3, 4])
    """Scale, bias and axis; the quadratic term alone; everything. Of the first three one alone is no cheaper than a
    cause beside a change that is left open."""

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        changes = jacobian(setting.parameters, setting.n, setting.norm)
        for i in range(len(setting.kinds)):
            for number, moved in enumerate(self.moves):
                columns = np.zeros((setting.rows, len(setting.kinds), 5))
                columns[:, i, moved] = changes[:, i, moved]
                yield Shape((i,), columns, (float(number),))


PATTERNS: tuple[Pattern, ...] = (
    SensorHarmonic(),
    RunHarmonic(),
    HarmonicSeries(),
    SensorPeriodic(),
    SensorTrend(),
    TemperatureCurve(),
    TemperatureWave(),
    StepInTemperature(),
    InputCurve(),
    TurningScale(),
    CommonHarmonic(),
    CommonPeriodic(),
    OwnChange(),
)
