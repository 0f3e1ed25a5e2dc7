"""IMU-TK (Tedaldi, Pretto, Menegatti, ICRA 2014): ASCII logs of raw converter counts of one Xsens MTi."""

from pathlib import Path

import numpy as np

from benchmarks.convert.contract import Converter, Document
from benchmarks.convert.documents import columns, session, triad
from benchmarks.convert.files import expect_count, one_containing, read_numbers, refuse
from estimator.wording import counted

GRAVITY = 9.81744
"""m/s², as the publication states it."""
COUNTS = 415.0
"""Nominal counts per m/s² of the Xsens MTi."""
GYRO_COUNTS = 4767.0
"""Nominal counts per rad/s."""
HALF_RANGE = 32768.0
"""Counts that stand for nothing: half of what 16 bits hold."""
FILES = "the accelerometer log and the gyroscope log, with `acc` and `gyro` in their names"


def convert(paths: list[Path]) -> list[tuple[str, Document]]:
    """Two logs with one clock → one raw session of three accelerometers and three gyros."""
    expect_count(paths, 2, FILES)
    accelerometer, gyro = one_containing(paths, "acc"), one_containing(paths, "gyro")
    acc, gyr = read_numbers(accelerometer, 4), read_numbers(gyro, 4)
    if len(acc) != len(gyr):
        raise refuse(
            gyro, "text", f"has {counted(len(gyr), 'line')} and {accelerometer.name} has {len(acc)}; they must match"
        )
    sensors = triad("A", COUNTS, "count") + triad("G", GYRO_COUNTS, "count", gyro=True)
    for entry in sensors:
        entry["nominal_offset"] = HALF_RANGE
    time = acc[:, 0]
    steps = np.diff(time)
    if not len(steps) or np.any(steps <= 0):
        row = int(np.argmax(steps <= 0)) + 2 if len(steps) else 1
        raise refuse(accelerometer, "time", "does not increase from line to line", row=row)
    table = {"time_s": time.tolist(), **columns(sensors, np.hstack([acc[:, 1:], gyr[:, 1:]]))}
    rate = float(1 / np.median(steps))
    notes = "IMU-TK recording, raw counts; positions set down by hand"
    return [
        (
            "imu-tk-xsens-mti.json",
            session("xsens-mti", sensors, table, gravity=GRAVITY, notes=notes, sample_rate_hz=round(rate, 3)),
        )
    ]


IMU_TK = Converter(
    name="imu-tk",
    description="Raw counts of one Xsens MTi set down by hand in many positions.",
    files=FILES,
    convert=convert,
)
