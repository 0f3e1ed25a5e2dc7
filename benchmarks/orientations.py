"""Blocks in arbitrary orientations, simulated: what P3 and the optimisation tables are measured on."""

from dataclasses import dataclass, replace

import numpy as np

from estimator import CalibrationSession, Sensor, Site
from estimator.arrays import unit
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array
from estimator.simulate import orientation_schedule, scattered, simulate

GRAVITY = 9.81
NOISE = 1e-5
"""g; one sigma of a reading."""


def axes_of(m: int) -> Array:
    """(m, 3) one axis up and the others about it at 70°: no three of four in one plane."""
    turn, half = 2 * np.pi * np.arange(m - 1) / (m - 1), np.radians(70)
    ring = np.column_stack([np.sin(half) * np.cos(turn), np.sin(half) * np.sin(turn), np.full(m - 1, np.cos(half))])
    return np.vstack([ring, [0.0, 0.0, 1.0]])


def two_axis_turns(count: int) -> Array:
    """(count, 3) directions that successive turns about two axes reach, a third of them on each of three levels."""
    k = np.arange(count)
    level = np.radians(np.array([-50.0, 0.0, 50.0]))[k % 3]
    turn = 2 * np.pi * (k // 3) / max(count // 3, 1) + 0.35 * (k % 3)
    return np.column_stack([np.cos(level) * np.cos(turn), np.cos(level) * np.sin(turn), np.sin(level)])


def sphere(count: int, rng: np.random.Generator) -> Array:
    """(count, 3) drawn evenly."""
    return unit(rng.standard_normal((count, 3)))


@dataclass(frozen=True, eq=False)
class Case:
    """A block of known truth in a set of orientations."""

    truth: SensorParameters
    schedule: CalibrationSession

    def measured(self, rng: np.random.Generator, noise: float = NOISE) -> CalibrationSession:
        """One session; ``noise`` in g."""
        return simulate(self.schedule, self.truth, rng, noise=0.12 * GRAVITY * noise)


def case(m: int, directions: Array, rng: np.random.Generator, size: float = 0.01) -> Case:
    """Scales, biases and axes off nominal by ``size`` (relative, g, rad), no quadratic term."""
    sensors = tuple(Sensor(f"A{i + 1}", ACCELEROMETER, axes_of(m)[i], 0.12, "V") for i in range(m))
    truth = scattered(sensors, np.full(m, GRAVITY), rng, scale=size, bias=size, quadratic=0.0, axis=size)
    schedule = orientation_schedule(sensors, Site(gravity=GRAVITY), directions)
    return Case(truth, schedule)


def one_degree_off(found: Case, rng: np.random.Generator) -> Case:
    """The case with the block set down a degree beside each orientation."""
    assert found.schedule.directions is not None
    off = unit(found.schedule.directions + np.radians(1.0) * rng.standard_normal(found.schedule.directions.shape))
    return Case(found.truth, replace(found.schedule, directions=off))
