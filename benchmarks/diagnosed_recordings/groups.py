"""Parts of the recordings that a person would choose: one triad, two, all; as raw logs and as means."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.diagnosed_recordings.still import adis16405, mpu6050
from benchmarks.recordings.sets import logs, recordings
from estimator.session import ACCELEROMETER, CalibrationSession

BOARD = "kth-mimu"
MORE_THAN_LOGS = 5
"""MPU-9150 logs; the recording's sixth session is the block of all five, means from the start."""


@dataclass(frozen=True, eq=False)
class Group:
    """Some sensors of one session."""

    recording: str
    words: str
    """Description of the sensors."""
    means: CalibrationSession
    log: CalibrationSession | None = None
    """The sensors' log before averaging; None where the recording begins with means."""


def some(session: CalibrationSession, names: list[str]) -> CalibrationSession:
    """The session with the sensors of these names."""
    keep = np.array([s.name in names for s in session.sensors])
    return replace(
        session,
        sensors=tuple(s for s in session.sensors if s.name in names),
        readings=session.readings[:, keep],
        standard_errors=session.standard_errors[:, keep],
        at_ends=None if session.at_ends is None else session.at_ends[:, keep],
        vibration=None if session.vibration is None else session.vibration[:, keep],
    )


def accelerometers(session: CalibrationSession, triads: int) -> list[str]:
    """Names of the accelerometers of the first triads."""
    return [s.name for s in session.sensors if s.kind == ACCELEROMETER][: 3 * triads]


def gyros(session: CalibrationSession) -> list[str]:
    """Names of all gyros."""
    return [s.name for s in session.sensors if s.kind != ACCELEROMETER]


def parts(recording: str, means: CalibrationSession, log: CalibrationSession | None) -> Iterator[Group]:
    """The groups of a session: triads of accelerometers, the gyros, everything."""
    count = len(accelerometers(means, len(means.sensors))) // 3
    chosen = {f"{n} triad{'s' * (n > 1)}": accelerometers(means, n) for n in (1, 2, count) if 0 < n <= count}
    if gyros(means):
        chosen["gyros alone"] = gyros(means)
    if len(means.sensors) > 3 * count > 0:
        chosen["all, with gyros"] = [s.name for s in means.sensors]
    for words, names in chosen.items():
        yield Group(recording, words, some(means, names), None if log is None else some(log, names))


def of_format(format_name: str) -> Iterator[Group]:
    """Groups of every session of a converted recording."""
    raw = {log.name: log.session for log in logs(format_name)}
    for r in recordings(format_name):
        log = raw[r.name]
        yield from parts(r.name, r.session, log if log.is_raw else None)


def still() -> Iterator[Group]:
    """Gyros that only lie still."""
    yield from parts("adis16405", adis16405(), None)
    yield from parts("mpu6050", mpu6050(), None)


SETS: tuple[Callable[[], Iterator[Group]], ...] = (
    lambda: of_format("imu-tk"),
    lambda: of_format("mpu9150-five"),
    lambda: of_format(BOARD),
    lambda: of_format("ferraris-csv"),
    still,
)
"""Every recording whose means carry standard errors; those of ctu-mat carry none that could be stated otherwise."""
