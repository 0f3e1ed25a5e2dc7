"""Five MPU-9150 moved together (Mikov, Reginya, Moschevikin, ICINS 2020): ASCII logs in SI.

The logs start up to 20 samples apart and two of them lack rows, so samples cannot be paired. Standstills can: each log
is averaged over its own, and those that all five share become the rows of one block of fifteen accelerometers. How
the five are turned against each other is not published; it is taken from the recording (Kabsch) as nominal axes.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.convert.contract import Converter, Document
from benchmarks.convert.documents import Columns, columns, session, triad
from benchmarks.convert.files import expect_count, read_numbers
from estimator.calibration.free import residual_per_freedom, tilt_response
from estimator.errors import FormatError, Problem
from estimator.reading import read_session
from estimator.session import CalibrationSession
from estimator.static import average

GRAVITY = 9.81
"""m/s², as the publication states it."""
RATE_HZ = 100.0
"""Sample rate stated by the data set."""
APART_S = 1.5
"""Largest difference of the middles of one standstill in two logs."""
FEWEST = 9
"""Orientations that a block of accelerometers needs at least."""
FILES = "the five logs, imu0.log to imu4.log"


def single(path: Path, number: int) -> tuple[str, Document]:
    """One log → one raw session of three accelerometers and three gyros."""
    values = read_numbers(path, 6)
    sensors = triad("A", 1.0, "m/s²") + triad("G", 1.0, "rad/s", gyro=True)
    document = session(
        f"mpu9150-{number}",
        sensors,
        columns(sensors, values),
        gravity=GRAVITY,
        notes=f"MPU-9150 recording {path.name}, turned by hand with standstills",
        sample_rate_hz=RATE_HZ,
    )
    return f"mpu9150-{number}.json", document


def shared(times: list[NDArray[np.float64]]) -> NDArray[np.intp]:
    """(standstills, logs) row of each standstill in each log, for those that all logs share."""
    nearest = [np.abs(times[0][:, None] - other).argmin(axis=1) for other in times]
    apart = [np.abs(times[0] - other[found]) for other, found in zip(times, nearest, strict=True)]
    common = np.flatnonzero(np.max(apart, axis=0) < APART_S)
    return np.stack([found[common] for found in nearest], axis=1)


def turn_to(source: Columns, target: Columns) -> Columns:
    """(3, 3) rotation that takes vectors ``source`` (n, 3) nearest to ``target``, biases aside."""
    U, _, Vt = np.linalg.svd((target - target.mean(axis=0)).T @ (source - source.mean(axis=0)))
    rotation: Columns = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    return rotation


def together(logs: list[CalibrationSession]) -> Document:
    """The averaged logs → one averaged session of fifteen accelerometers."""
    rows = shared([log.time for log in logs if log.time is not None])
    if len(rows) < FEWEST:
        raise FormatError([Problem("files", f"share {len(rows)} standstills; they are not one common motion")])
    means = [log.readings[rows[:, k], :3] for k, log in enumerate(logs)]
    errors = [log.standard_errors[rows[:, k], :3] for k, log in enumerate(logs)]
    sensors = [
        entry
        for k, own in enumerate(means, start=1)
        for entry in triad(f"A{k}", 1.0, "m/s²", axes=turn_to(own, means[0]).T)
    ]
    table = columns(sensors, np.hstack(means))
    table |= {f"{name}_se": column for name, column in columns(sensors, np.hstack(errors)).items()}
    return session(
        "mpu9150-five",
        sensors,
        table,
        gravity=GRAVITY,
        notes="Five MPU-9150 moved together, averaged over their common standstills; nominal axes from the recording",
    )


def convert(paths: list[Path]) -> list[tuple[str, Document]]:
    """Five logs → five raw sessions of one IMU each, and one averaged session of the redundant block."""
    expect_count(paths, 5, FILES)
    singles = [single(path, k) for k, path in enumerate(sorted(paths), start=1)]
    averaged = [average(read_session(document), residual_per_freedom, tilt_response) for _, document in singles]
    return [*singles, ("mpu9150-five.json", together(averaged))]


MPU9150_FIVE = Converter(
    name="mpu9150-five",
    description="Five IMUs turned together by hand: five triads, and one redundant block of fifteen accelerometers.",
    files=FILES,
    convert=convert,
)
