"""One session for every cause with the cause hidden in it, or not, at a chosen strength."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from estimator import CalibrationSession, Diagnosis, diagnose
from estimator.applied_vector import stand_geometry
from estimator.causes import RecordCorrection, Signature, cause
from estimator.diagnosis.residuals.fitted import stand_baseline
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import ACCELEROMETER, GYROSCOPE, Array
from estimator.simulate import orientation_schedule, simulate
from tests.builders import GRAVITY
from tests.estimator.calibration.cases import SITE, accelerometers, block, gyros, sphere
from tests.estimator.causes.physics import ACTED, SENSOR, World
from tests.estimator.causes.worlds import truth_of, wandering

STRENGTH = 40.0
"""Standard errors of a reading, after the baseline (and with the history, where the cause needs one)."""

SHAPES = {
    "warm-up": (900.0,),
    "thermal-lag": (900.0,),
    "bias-jump": (17.0,),
    "reading-outlier": (17.0,),
    "sensor-drift": (0.0, 1.0, 0.0, 0.0),
}
"""Nonlinear parameters of the hidden effects."""

DIRECTION = {"sensor-drift": (0.0, 1.0, 0.0, 0.0), "flip-misalignment": (1.0, -1.0, 1.0)}
"""Mix of amplitudes; all alike where not stated."""


@dataclass(frozen=True, eq=False)
class Scene:
    """A schedule, its noise and how many earlier sessions there are."""

    world: World
    noise: Array
    """(m,) reading units."""
    history: int = 0

    def measured(self, seed: int) -> CalibrationSession:
        """One session without an effect."""
        return simulate(self.world.session, self.world.truth, np.random.default_rng(seed), noise=self.noise)

    def earlier(self, seed: int) -> list[CalibrationSession]:
        """The history."""
        return [self.measured(100 * seed + k) for k in range(1, self.history + 1)]


@cache
def scene(kind: str, history: int) -> Scene:
    """Six accelerometers or gyros on the stand; or three of each lying still in 40 directions."""
    if kind == "orientations":
        sensors = (*accelerometers(3), *gyros(3, scale=1.0, unit="rad/s"))
        session = orientation_schedule(sensors, SITE, sphere(40))
        return Scene(World(session, truth_of(session)), np.array([3e-5] * 3 + [2e-4] * 3))
    sensors = accelerometers() if kind == ACCELEROMETER else gyros(6, scale=1e4, unit="V")
    session = wandering(block(sensors, 24))
    return Scene(World(session, truth_of(session)), np.full(6, 3e-6 if kind == ACCELEROMETER else 3e-4), history)


def scene_for(identifier: str) -> Scene:
    """A scene in which a cause can be seen."""
    known = cause(identifier)
    if identifier == "g-sensitivity":
        return scene("orientations", 0)
    gyro = known.kind == GYROSCOPE
    entered = isinstance(known, Signature) and "nominal or history" in known.needs
    return scene(GYROSCOPE if gyro else ACCELEROMETER, 2 if "history" in known.needs or entered else 0)


def spoilt(identifier: str, session: CalibrationSession, where: Scene, rng: np.random.Generator) -> CalibrationSession:
    """The session with the cause in it."""
    known = cause(identifier)
    if isinstance(known, RecordCorrection):
        ways = list(known.corrected(session))
        return ways[len(ways) // 2][1]
    if not isinstance(known, Signature):
        noise = 5 * where.noise[SENSOR] * rng.standard_normal(len(session.readings))
        return with_readings(session, noise[:, None] * np.eye(len(where.noise))[SENSOR])
    if identifier == "saturation":
        limit = np.sort(np.abs(session.readings[:, SENSOR]))[-4]
        readings = session.readings.copy()
        readings[:, SENSOR] = np.clip(readings[:, SENSOR], -limit, limit)
        return replace(session, readings=readings)
    if identifier == "g-sensitivity":
        pulled = GRAVITY * where.world.session.directions @ np.full(3, 5e-5)
        return with_readings(session, pulled[:, None] * np.eye(6)[3 + SENSOR])
    return with_readings(session, change(identifier, where) * where.world.truth.scale)


def with_readings(session: CalibrationSession, more: Array) -> CalibrationSession:
    """The session with something added to its readings (R, m)."""
    return replace(session, readings=session.readings + more)


def change(identifier: str, where: Scene) -> Array:
    """(R, m) change of the input by the cause, m/s² or rad/s, scaled to `STRENGTH`."""
    world, shape = where.world, SHAPES.get(identifier, ())
    before = world.inputs(world.vectors())
    k = 1e-9 * np.array(DIRECTION.get(identifier, np.ones(len(cause(identifier).units))))
    for _ in range(3):
        added = ACTED[identifier](world, k, SENSOR, shape) - before
        k = k * STRENGTH / strength(added, where)
    return np.asarray(ACTED[identifier](world, k, SENSOR, shape) - before)


def strength(added: Array, where: Scene) -> float:
    """Norm of what the baseline leaves of (R, m) inputs, in standard errors; of all of it where the history tells."""
    world = where.world
    repeatability = np.array([s.bias_repeatability for s in world.session.sensors])
    variance = (where.noise / world.truth.scale) ** 2 + repeatability**2
    nothing = np.zeros(added.shape)
    at = stand_baseline(world.session, world.truth, stand_geometry(world.session), nothing, nothing + variance)
    residuals = WhitenedResiduals.of(at)
    trace = residuals.whitened(added[..., None]) if where.history else residuals.trace(added[..., None])
    return float(np.linalg.norm(trace))


@cache
def found(identifier: str, seed: int = 1) -> Diagnosis:
    """The diagnosis of a session with the cause hidden in it."""
    where = scene_for(identifier)
    session = spoilt(identifier, where.measured(seed), where, np.random.default_rng(seed + 50))
    return diagnose(session, where.earlier(seed))


@cache
def undisturbed(where: Scene, seed: int = 1) -> Diagnosis:
    """The diagnosis of a session without an effect."""
    return diagnose(where.measured(seed), where.earlier(seed))
