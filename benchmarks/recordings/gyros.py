"""Gyros at rest: the held-out error of their readings before and after a cause is named."""

from collections.abc import Iterator

from benchmarks.diagnosed_recordings.still import mpu6050
from benchmarks.recordings.sets import recordings
from benchmarks.recordings.tables import table
from estimator import diagnose
from estimator.session import GYROSCOPE, CalibrationSession

DEGREES_AN_HOUR = 206_264.8
"""Degrees an hour in a rad/s."""


def gyros() -> str:
    """Root mean square over rows that took no part, of all gyros together."""
    return table(["recording", "named", "before, °/h", "after, °/h"], _lines())


def _lines() -> Iterator[list[str]]:
    for recording, session in _sessions():
        found = diagnose(session)
        assert found.gain is not None
        names = ", ".join(f"`{one.cause}` ({', '.join(one.sensors)})" for one in found.findings)
        scores = (found.gain.before, found.gain.after)
        yield [recording, names, *(f"{DEGREES_AN_HOUR * score.rms_by_kind[GYROSCOPE]:.0f}" for score in scores)]


def _sessions() -> Iterator[tuple[str, CalibrationSession]]:
    yield "imu-tk-xsens-mti", recordings("imu-tk")[0].session
    yield "mpu6050 cold start", mpu6050()
