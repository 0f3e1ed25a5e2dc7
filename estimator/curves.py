"""Bias and scale factor over temperature, as a thermal programme finds them; no algorithms.

    K(T) = Σ K_k·(T − T₀)^k,    b(T) = Σ b_k·(T − T₀)^k,    T₀ the reference temperature

(IEEE Std 1293 and 952 state thermal models in this form.) The band of a curve is one sigma of it at a temperature: the
covariance of the coefficients, that of terms left out among them, what scatters about the curve from temperature to
temperature, and half the width of a hysteresis loop, since in use nobody knows the leg.
"""

from dataclasses import dataclass

import numpy as np

from estimator.codec import Document
from estimator.coverage import coverage_factor
from estimator.session import Array

HYSTERESIS, LAG, MISFIT = "hysteresis", "lag", "lack-of-fit"
"""Effects that readings may show beside a curve."""


@dataclass(frozen=True, eq=False)
class Curve(Document):
    """One parameter over temperature; q coefficients, those above the order zero."""

    coefficients: Array
    """(q,) SI (for a scale factor reading units per SI) per K^k."""
    order: int
    """Order of the polynomial that the readings ask for."""
    covariance: Array
    """(q, q) covariance of the coefficients, those left out included."""
    scatter: float = 0.0
    """One sigma of what no such polynomial follows, from temperature to temperature; SI."""
    loop: float = 0.0
    """Width of the hysteresis loop in the middle of the range, the warming leg above; SI."""
    dof: float | None = None
    """Effective degrees of freedom of the covariance; None when the noise is known."""


@dataclass(frozen=True, eq=False)
class SensorCurves(Document):
    """The curves of one sensor."""

    name: str
    bias: Curve
    scale: Curve | None = None
    """Curve of the scale factor; None where the session does not show it, as for gyros at rest."""
    cross: Array | None = None
    """(q, q) covariance of the scale factor's coefficients with the bias'."""


@dataclass(frozen=True)
class ThermalFinding(Document):
    """An effect that the readings of a sensor show beside its curve."""

    kind: str
    sensor: str
    parameter: str
    amplitude: float
    """Warming less cooling in the middle of the range; of a lag the largest departure; of a misfit its sigma; SI."""
    sigma: float
    """One sigma of the amplitude; 0 for a misfit."""
    p_value: float
    """Chance of as large an effect where there is none, over all sensors and forms tried."""
    time_constant: float | None = None
    """Time constant of a lag, s."""
    alternatives: tuple[str, ...] = ()
    """Kinds that explain the same readings nearly as well."""


@dataclass(frozen=True, eq=False)
class ThermalCurves(Document):
    """Results of a thermal programme over temperature."""

    reference_temperature: float
    """T₀, °C."""
    lowest: float
    """°C, of the readings."""
    highest: float
    """°C."""
    sensors: tuple[SensorCurves, ...]
    findings: tuple[ThermalFinding, ...] = ()

    def sensor(self, name: str) -> SensorCurves:
        """The curves of the sensor called ``name``; KeyError if there are none."""
        return {s.name: s for s in self.sensors}[name]

    def powers(self, temperature: Array, count: int) -> Array:
        """(n, count) powers of T − T₀, K^k, of temperatures (n,), °C."""
        return np.vander(np.atleast_1d(temperature) - self.reference_temperature, count, increasing=True)

    def value(self, curve: Curve, temperature: Array) -> Array:
        """(n,) values of the parameter, SI, at temperatures (n,), °C."""
        return self.powers(temperature, len(curve.coefficients)) @ curve.coefficients

    def sigma(self, curve: Curve, temperature: Array) -> Array:
        """(n,) one sigma of it, SI, at temperatures (n,), °C: the band."""
        powers = self.powers(temperature, len(curve.coefficients))
        x = (np.atleast_1d(temperature) - self.lowest) / (self.highest - self.lowest)
        half = curve.loop * 2 * np.clip(x * (1 - x), 0.0, None)
        return np.sqrt(((powers @ curve.covariance) * powers).sum(axis=1) + curve.scatter**2 + half**2)

    def expanded(self, curve: Curve, temperature: Array, k: float = 2.0) -> Array:
        """(n,) U, SI: the band that covers what ``k`` covers when the noise is known."""
        return coverage_factor(k, curve.dof) * self.sigma(curve, temperature)
