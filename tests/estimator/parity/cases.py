"""Blocks, their reference calibrations, flights, and changes of one sensor."""

from dataclasses import replace

import numpy as np

from estimator.calibration import calibrate
from estimator.parameters import SensorParameters
from estimator.parity.flight import AEROBATIC, Manoeuvre, Weather, fly
from tests.estimator.calibration.free_sessions import session, sphere, truth

STILL = (Manoeuvre(60.0, pitch=0.3, side=0.2),)
"""One orientation."""


def block(m, seed=0, noise=1e-4):
    """Truth and its reference calibration."""
    rng = np.random.default_rng(seed)
    true = truth(m, seed=seed)
    return true, calibrate(session(true, sphere(40, rng), noise=noise, rng=rng), quadratic=False)


def recording(true, seed=0, *, manoeuvres=AEROBATIC, **options):
    """A flight of the block as it is now; its sensors sit in one point."""
    rng = np.random.default_rng(1000 + seed)
    sensors = session(true, np.eye(3)).sensors
    now = SensorParameters(true.scale, true.bias, true.quadratic, true.axes)
    return fly(sensors, now, rng, manoeuvres=manoeuvres, **{"weather": Weather(vibration=0.2), **options})


def biased(true, sensor, size):
    """The zero moved, m/s²."""
    return replace(true, bias=true.bias + size * np.eye(len(true.bias))[sensor])


def scaled(true, sensor, size):
    """The scale moved, relative."""
    return replace(true, scale=true.scale * (1 + size * np.eye(len(true.bias))[sensor]))


def tilted(true, sensor, turn):
    """The axis moved by a small rotation vector (3,), rad."""
    axes = true.axes.copy()
    axes[sensor] += np.cross(turn, axes[sensor])
    return replace(true, axes=axes / np.linalg.norm(axes, axis=1, keepdims=True))
