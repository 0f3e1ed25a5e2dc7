"""Small sessions: four accelerometers, two dozen rows."""

from dataclasses import replace
from functools import cache

import numpy as np

from estimator import CalibrationSession
from estimator.causes import cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.session import Array
from tests.estimator.calibration.cases import accelerometers, block
from tests.estimator.causes.hiding import SHAPES, STRENGTH, Scene, strength, with_readings
from tests.estimator.causes.physics import ACTED, World
from tests.estimator.causes.worlds import truth_of, wandering

_SCHEDULE = wandering(block(accelerometers(4), 12))
WHERE = Scene(World(_SCHEDULE, truth_of(_SCHEDULE)), np.full(4, 3e-6))
ROWS = len(_SCHEDULE.readings)
TIME, BETA = _SCHEDULE.time, _SCHEDULE.beta
SENSOR = 1
"""The sensor on which `effect` acts, where it acts on one."""


@cache
def effect(identifier: str, sensor: int = SENSOR) -> Array:
    """(R, m) change of the readings by a cause at a strength of forty standard errors, V."""
    world, k = WHERE.world, 1e-9 * np.ones(len(cause(identifier).units))
    for _ in range(3):
        added = ACTED[identifier](world, k, sensor, SHAPES.get(identifier, ())) - world.inputs(world.vectors())
        k = k * STRENGTH / strength(added, WHERE)
    return np.asarray(added * world.truth.scale)


def on_sensor(course: Array, sensor: int = SENSOR) -> Array:
    """(R, m) a course (R,), in standard errors, added to one sensor's readings, V."""
    return course[:, None] * WHERE.noise * np.eye(4)[sensor]


def measured(added: Array | float = 0.0, seed: int = 1) -> CalibrationSession:
    """A session with something added to its readings (R, m), V."""
    return with_readings(WHERE.measured(seed), np.zeros((ROWS, 4)) + added)


def swaying(size: float) -> Array:
    """(R, m) V, what a stand does whose head nods twice a turn, more in the second run."""
    setting = baseline_of(measured()).setting
    assert setting.beta is not None
    assert setting.flipped is not None
    assert setting.d_alpha is not None
    course = size * np.cos(2 * setting.beta + 0.3) * (1 + setting.flipped)
    return np.asarray(setting.through(setting.d_alpha[..., None])[..., 0] * course[:, None] * setting.parameters.scale)


def stated(session: CalibrationSession, factor: float, sensors: slice = slice(None)) -> CalibrationSession:
    """The session with some standard errors, of repetition too, stated too large by a factor."""
    errors, known = session.standard_errors.copy(), list(session.sensors)
    errors[:, sensors] *= factor
    known[sensors] = [replace(s, bias_repeatability=factor * s.bias_repeatability) for s in known[sensors]]
    return replace(session, standard_errors=errors, sensors=tuple(known))
