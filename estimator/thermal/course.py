"""The course of temperature in a session: its levels, the polynomials that it supports, warming and cooling legs.

Curves are fitted in Legendre polynomials of x = (2T − T_max − T_min)/(T_max − T_min), which readings spread over the
range keep nearly independent, and written in powers of T − T₀.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leg2poly, legvander

from estimator.causes.lag import lagging
from estimator.errors import Problem, ScheduleError
from estimator.message import say
from estimator.session import Array, CalibrationSession

REFERENCE = 20.0
"""°C, the reference temperature of measurement (ISO 1), where the session covers it; else the middle of its range."""
HIGHEST_ORDER = 4
"""Highest order of a polynomial: IEEE Std 1293 and 952 are content with three or four."""
APART = 2.0
"""°C between two levels of temperature: a chamber holds a soak closer than that."""
NARROWEST = 10.0
"""°C of range below which a room may do as much, and a curve shows nothing."""
TURN = 0.05
"""Part of the range by which the temperature must return for a leg to have ended: noise and overshoot are less."""
LAGS = 8
"""Time constants that are tried, from the spacing of rows to a sixteenth of the span: a longer lag is a drift."""


@dataclass(frozen=True, eq=False)
class TemperatureCourse:
    """Temperatures of R rows."""

    temperature: Array
    """(R,) °C."""
    time: Array | None
    """(R,) s."""
    levels: int
    """Different temperatures."""

    @property
    def lowest(self) -> float:
        """°C."""
        return float(self.temperature.min())

    @property
    def highest(self) -> float:
        """°C."""
        return float(self.temperature.max())

    @property
    def reference(self) -> float:
        """T₀, °C."""
        if self.lowest <= REFERENCE <= self.highest:
            return REFERENCE
        return round((self.lowest + self.highest) / 2)

    @property
    def order(self) -> int:
        """Highest that leaves a level to judge by; a line of two levels leaves none."""
        return int(np.clip(self.levels - 2, 1, HIGHEST_ORDER))

    def x(self, temperature: Array) -> Array:
        """(n,) temperatures scaled to −1 … 1 over the range, from temperatures (n,), °C."""
        return (2 * temperature - self.highest - self.lowest) / (self.highest - self.lowest)

    def basis(self, order: int) -> Array:
        """(R, order + 1) Legendre polynomials, dimensionless."""
        return np.asarray(legvander(self.x(self.temperature), order))

    def to_powers(self, order: int) -> Array:
        """(order + 1, order + 1) transformation of Legendre coefficients to those of (T − T₀)^k, K^−k."""
        x0 = float(self.x(np.array(self.reference)))
        inner = Polynomial([x0, 2 / (self.highest - self.lowest)])
        change = np.zeros((order + 1, order + 1))
        for k in range(order + 1):
            change[: k + 1, k] = Polynomial(leg2poly(np.eye(order + 1)[k, : k + 1]))(inner).coef
        return change

    @property
    def leg(self) -> Array:
        """(R,) 1 while the temperature rises, −1 while it falls, 0 before its first move."""
        enough = max(TURN * (self.highest - self.lowest), APART)
        leg, extreme, legs = 0, self.temperature[0], []
        for celsius in self.temperature.tolist():
            if leg == 0 and abs(celsius - extreme) > enough:
                leg, extreme = int(np.sign(celsius - extreme)), celsius
            elif leg * (celsius - extreme) > 0:
                extreme = celsius
            elif leg * (extreme - celsius) > enough:
                leg, extreme = -leg, celsius
            legs.append(leg)
        return np.array(legs, dtype=float)

    @property
    def loop(self) -> Array:
        """(R,) a hysteresis loop that is one wide in the middle of the range and closed at its ends, dimensionless."""
        return self.leg * (1 - self.x(self.temperature) ** 2) / 2

    @property
    def time_constants(self) -> Array:
        """(n,) s, that a lag is looked for at; none without times."""
        if self.time is None or np.ptp(self.time) <= 0:
            return np.zeros(0)
        span = float(np.ptp(self.time))
        return np.geomspace(min(span / len(self.time), span / 64), span / 16, LAGS)

    def behind(self, time_constant: float) -> Array:
        """(R,) K by which what follows the temperature with a time constant, s, is behind it."""
        assert self.time is not None
        return lagging(self.temperature, self.time, time_constant) - self.temperature


def course_of(session: CalibrationSession) -> TemperatureCourse:
    """The course of a session; ScheduleError where it shows nothing over temperature."""
    T = session.temperature
    if T is None:
        missing = say("the column is missing; {programme} needs it", programme=session.programme)
        raise ScheduleError([Problem("temperature_c", missing)])
    spread = float(np.ptp(T))
    if spread < NARROWEST:
        parts = {"spread": f"{spread:.3g}", "least": f"{NARROWEST:g}"}
        problem = say("the readings span {spread} °C; a curve over temperature needs {least} °C or more", **parts)
        raise ScheduleError([Problem("temperature_c", problem)])
    return TemperatureCourse(T, session.time, levels_of(T))


def levels_of(temperature: Array) -> int:
    """Temperatures (R,), °C, that lie `APART` from one another."""
    count, last = 0, -np.inf
    for celsius in np.sort(temperature).tolist():
        if celsius - last > APART:
            count, last = count + 1, celsius
    return count
