"""The parameters of a block's sensors and their flat, named, dimensionless vector.

Five elements a sensor: ln K, b/|n|, c·|n|, and the axis' turns along its two tangents. Dimensionless, so that one
number says for each of them what is small: `PLAUSIBLE`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from estimator.arrays import tangents, unit
from estimator.session import ACCELEROMETER, Array, Sensor

ELEMENTS = ("scale", "bias", "quadratic", "axis_1", "axis_2")
"""Elements of one sensor, in the order of every parameter vector."""

PLAUSIBLE = 0.1
"""One sigma of what a dimensionless element could be at all: 10 % of scale, 0.1 g, 0.1/g, 0.1 rad.

A choice: several times wider than the tolerance of any instrument, so that it decides nothing that readings tell; yet
finite, so that what they do not tell stays where it was stated instead of making the equations singular."""

LIMIT = 0.3 * PLAUSIBLE
"""Dimensionless one sigma below which an element counts as observed: the rows then give ten times the
information that the plausible range alone would."""


@dataclass(frozen=True, eq=False)
class SensorParameters:
    """K, b, c, e of m sensors; leading axes (sessions) are free. Units: see the package page."""

    scale: Array
    """(..., m) reading units per m/s² (rad/s)."""
    bias: Array
    """(..., m) m/s² (rad/s)."""
    quadratic: Array
    """(..., m) s²/m (s/rad)."""
    axis: Array
    """(..., m, 3) unit vectors, block axes."""

    @cached_property
    def axis_tangents(self) -> Array:
        """(..., m, 3, 2) along which the axes turn, dimensionless."""
        return tangents(self.axis)

    def at(self, sessions: Array | int) -> "SensorParameters":
        """The parameters of one session, or of several, by their place (number, or (k,) of them) on the first axis."""
        return SensorParameters(
            self.scale[sessions], self.bias[sessions], self.quadratic[sessions], self.axis[sessions]
        )

    def stepped(self, step: Array, norm: Array) -> "SensorParameters":
        """Moved by a dimensionless step (..., m, 5); ``norm`` (m,) is the applied vector's length, m/s² (rad/s)."""
        turned = self.axis + (self.axis_tangents @ step[..., 3:, None])[..., 0]
        return SensorParameters(
            scale=self.scale * np.exp(step[..., 0]),
            bias=self.bias + step[..., 1] * norm,
            quadratic=self.quadratic + step[..., 2] / norm,
            axis=unit(turned),
        )

    def si_factors(self, norm: Array) -> Array:
        """(..., 5 m) factors from dimensionless elements to SI; ``norm`` (m,) as in `stepped`, m/s² (rad/s)."""
        ones = np.ones_like(self.scale)
        factors = np.stack([self.scale, ones * norm, ones / norm, ones, ones], axis=-1)
        return factors.reshape(*self.scale.shape[:-1], -1)


def together(sets: Sequence[SensorParameters]) -> SensorParameters:
    """Parameters (m,) of S sessions as (S, m)."""
    return SensorParameters(
        *(np.stack([getattr(p, attribute.name) for p in sets]) for attribute in fields(SensorParameters))
    )


def names(sensors: tuple[Sensor, ...]) -> tuple[str, ...]:
    """(5 m,) ``A1.scale``, ``A1.bias``, … in the order of every parameter vector."""
    return tuple(f"{s.name}.{element}" for s in sensors for element in ELEMENTS)


def units(sensors: tuple[Sensor, ...]) -> tuple[str, ...]:
    """(5 m,) the SI unit of every element."""

    def of(sensor: Sensor) -> tuple[str, ...]:
        if sensor.kind == ACCELEROMETER:
            return (f"{sensor.reading_unit}/(m/s²)", "m/s²", "s²/m", "rad", "rad")
        return (f"{sensor.reading_unit}/(rad/s)", "rad/s", "s/rad", "rad", "rad")

    return tuple(u for s in sensors for u in of(s))


def nominal(sensors: tuple[Sensor, ...]) -> SensorParameters:
    """The maker's parameters: nominal scale and axis, no bias, no nonlinearity."""
    zero = np.zeros(len(sensors))
    return SensorParameters(
        scale=np.array([s.nominal_scale for s in sensors]),
        bias=zero,
        quadratic=zero,
        axis=np.stack([s.nominal_axis for s in sensors]),
    )
