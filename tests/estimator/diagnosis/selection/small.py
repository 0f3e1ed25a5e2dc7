"""Small sessions for the search: four accelerometers, two dozen rows, few causes to choose from."""

from functools import cache

import numpy as np

from estimator import CalibrationSession
from estimator.causes import cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.selection.search_state import Detection, SearchState
from estimator.diagnosis.selection.start import begin
from estimator.diagnosis.signatures.scores import score
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


def start(
    identifiers: tuple[str, ...], added: Array | float = 0.0, history: tuple[CalibrationSession, ...] = ()
) -> SearchState:
    """The search for some causes in such a session."""
    return begin(baseline_of(measured(added)), [baseline_of(h) for h in history], [cause(i) for i in identifiers])


def candidate(
    state: SearchState, identifier: str, sensors: tuple[int, ...] = (SENSOR,), *, open_change: bool = False
) -> Detection:
    """A cause at its best shape, as if it had been selected; with the sensor's change since the history left open."""
    traces = [
        t for t in state.traces if t.cause.identifier == identifier and (t.width > len(t.cause.units)) == open_change
    ]
    own = [s for s in score(state.residuals, traces, state.attributed()) if s.sensors == sensors]
    best = max(own, key=lambda s: s.log_evidence)
    return Detection(best, best.p_value, ((best, best.log_evidence),))


def names(state: SearchState) -> list[tuple[str, tuple[int, ...]]]:
    """Causes that were found, with their sensors, in order."""
    return sorted(f.best.group for f in state.detections)
