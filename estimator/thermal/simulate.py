"""Thermal sessions whose truth is known: still orientations at soaks, and what temperature does to their readings.

    u' = κ(T)·(u + K·Δb(T)),    κ = 1 + Σ κ_k·(T − T₀)^k,    Δb = Σ b_k·(T − T₀)^k,    k ≥ 1

takes readings u of sensors at T₀ to those at T: there K is κ(T)·K and b is b + Δb(T).
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, THERMAL, Array, CalibrationSession, Sensor
from estimator.thermal.course import REFERENCE

SOAKS = (20.0, -40.0, -10.0, 20.0, 45.0, 70.0, 45.0, 20.0, -10.0)
"""°C: down, up, and down again, so that warming and cooling pass the same temperatures."""
SOAKING, ROW = 3600.0, 120.0
"""s from soak to soak, and from row to row."""
UNSTEADY = 0.2
"""°C, one sigma of a chamber's temperature."""


@dataclass(frozen=True, eq=False)
class ThermalLaw:
    """Effect of temperature on m sensors; column k of (K⁻¹, K⁻², …)."""

    scale: Array
    """(m, n) relative."""
    bias: Array
    """(m, n) m/s² (rad/s)."""


def thermal_schedule(
    orientations: CalibrationSession, rng: np.random.Generator, temperatures: tuple[float, ...] = SOAKS
) -> CalibrationSession:
    """Orientations, still to be measured, repeated at every soak; ``temperatures`` in °C."""
    n, soaks = len(orientations.readings), len(temperatures)
    assert orientations.directions is not None
    empty = np.zeros((n * soaks, len(orientations.sensors)))
    rows = np.arange(n * soaks)
    return replace(
        orientations,
        programme=THERMAL,
        readings=empty,
        standard_errors=empty,
        directions=np.tile(orientations.directions, (soaks, 1)),
        time=ROW * rows + SOAKING * (rows // n),
        temperature=np.repeat(temperatures, n) + UNSTEADY * rng.standard_normal(n * soaks),
    )


def usual_law(sensors: tuple[Sensor, ...], rng: np.random.Generator) -> ThermalLaw:
    """Law of good instruments: over 50 °C 1 mg and 0.5 mg bent, 0.2 % and 0.05 % bent; gyros 0.02 and 0.01 °/s."""
    accelerometer = np.array([s.kind == ACCELEROMETER for s in sensors])[:, None]
    span = np.array([50.0, 50.0**2])
    bias = np.where(accelerometer, [1e-2, 5e-3], [3.5e-4, 1.7e-4]) / span
    scale = np.where(accelerometer, [2e-3, 5e-4], 0.0) / span
    shape = (len(sensors), 2)
    return ThermalLaw(scale * rng.standard_normal(shape), bias * rng.standard_normal(shape))


def over_temperature(session: CalibrationSession, truth: SensorParameters, law: ThermalLaw) -> CalibrationSession:
    """The session, simulated at the reference temperature with ``truth`` (m,), as it reads at its temperatures."""
    assert session.temperature is not None
    powers = np.vander(session.temperature - REFERENCE, law.scale.shape[1] + 1, increasing=True)[:, 1:]
    gain = 1 + powers @ law.scale.T
    offset = np.array([s.nominal_offset or 0.0 for s in session.sensors])
    moved = gain * (session.readings - offset + truth.scale * (powers @ law.bias.T)) + offset
    return replace(session, readings=moved, standard_errors=gain * session.standard_errors)
