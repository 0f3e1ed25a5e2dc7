"""Records at rest whose course is known, for the tests of readiness."""

import numpy as np

from estimator.readiness import Allowed, Question, Readiness, readiness
from estimator.session import ACCELEROMETER, ARBITRARY_ORIENTATIONS, Array, CalibrationSession
from service.demo.blocks import ACCELEROMETER_SCALE, MICRO_G, sensors_of

G = 9.80665
PERIOD = 10.0
"""s between rows."""
FORCE = np.array([0.0, G, 0.0])
QUESTION = Question({ACCELEROMETER: Allowed(50 * MICRO_G, 100e-6, 20e-6 / G)}, duration=96 * 60.0)


def clock(minutes: float) -> Array:
    """(n,) s."""
    return PERIOD * np.arange(int(60 * minutes / PERIOD))


def record(course: Array, white: float = 0.5, seed: int = 3) -> CalibrationSession:
    """Rows every ten seconds; ``course`` (n, m) and ``white`` in µg."""
    rng = np.random.default_rng(seed)
    sensors = sensors_of(ACCELEROMETER, course.shape[1])
    force = np.stack([s.nominal_axis for s in sensors]) @ FORCE
    read = force + MICRO_G * (course + white * rng.standard_normal(course.shape))
    return CalibrationSession(
        unit="BA-1", block=ACCELEROMETER, programme=ARBITRARY_ORIENTATIONS, sensors=sensors,
        readings=ACCELEROMETER_SCALE * read, standard_errors=np.full(read.shape, np.nan),
        time=PERIOD * np.arange(len(read)),
    )  # fmt: skip


def judged(session: CalibrationSession, question: Question = QUESTION) -> Readiness:
    """The answer, always by the same draws."""
    return readiness(session, question, np.random.default_rng(1))
