"""A zero that follows the temperature, but not at once: the sensor warms and cools later than the thermometer.

The sensor's own temperature L obeys τ·dL/dt = T − L, a body of one heat capacity behind one thermal resistance
(lumped capacity; Incropera et al., Fundamentals of Heat and Mass Transfer, 5.1). Between two rows T is taken to rise
steadily, T(t) = T₀ + r·(t − t₀), for which the solution is exact:

    L(t) = T(t) − r·τ + (L₀ − T₀ + r·τ)·exp(−(t − t₀)/τ)

What it was before the first row nobody recorded: it is taken to be in equilibrium there, L = T. So warming and cooling
through one temperature give two zeros; for τ → 0 the zero follows the temperature itself (`bias-temperature`), and for
a short τ the lag is −r·τ (`temperature-rate`).
"""

from collections.abc import Iterator
from math import exp

import numpy as np

from estimator.causes.contract import SensorCause, Setting, Shape, column
from estimator.session import Array

STEP = 1e-3
"""Step of ln τ for the derivative: its square is far below what any reading resolves, rounding far below that."""


def lagging(temperature: Array, time: Array, tau: float) -> Array:
    """(R,) °C, what follows ``temperature`` (R,), °C, at rising ``time`` (R,), s, with the time constant τ, s.

    In no time nothing changes.
    """
    T, passed = temperature.tolist(), np.diff(time).tolist()
    lagged = [T[0]]
    for before, now, step in zip(T, T[1:], passed, strict=False):
        behind = (now - before) / step * tau if step > 0 else 0.0
        lagged.append(now - behind + (lagged[-1] - before + behind) * exp(-step / tau) if step > 0 else lagged[-1])
    return np.array(lagged)


class ThermalLag(SensorCause):
    """The nonlinear parameter is τ, s."""

    identifier = "thermal-lag"
    scope = "environment"
    equation = "k·(L − L̄), τ·dL/dt = T − L, τ free, L = T at the first row"
    units = ("m/s²/K",)
    needs = frozenset({"temperature", "time"})
    nonlinear_units = ("s",)
    shape_words = "time constant"
    alike = True
    sentence = "The bias of {sensors} lags the temperature: it differs between warming and cooling."
    advice = (
        "Change the temperature more slowly than the time constant, or let the unit soak; model the coefficient with "
        "its time constant until then."
    )
    shared_sentence = "The biases of {sensors} lag the temperature together."
    shared_advice = "Change the temperature more slowly than the time constant, or let the unit soak before measuring."
    steps = 10

    def available(self, setting: Setting) -> bool:
        return super().available(setting) and setting.time is not None and bool(np.all(np.diff(setting.time) > 0))

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        """Time constants from the spacing of the rows, below which L is the temperature itself, to their whole span,
        beyond which L is its sum.
        """
        assert setting.time is not None
        span = float(np.ptp(setting.time))
        yield from ((float(tau),) for tau in np.geomspace(span / max(setting.rows, 2), span, self.steps))

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) L − L̄, °C."""
        assert setting.temperature is not None
        assert setting.time is not None
        late = lagging(setting.temperature, setting.time, nonlinear[0])
        return column(late - late.mean())

    def neighbours(self, setting: Setting, shape: Shape) -> Iterator[Shape]:
        (i,), (tau,) = shape.sensors, shape.nonlinear
        for factor in np.geomspace(0.6, 1.7, 23):
            near = (float(tau * factor),)
            yield Shape(shape.sensors, self.placed(setting, i, near), near)
