"""Two recordings of a unit that only lies still, as gyro sessions: means over stretches of one position.

One position shows a gyro's zero and how it wanders, and nothing of an accelerometer: its scale, zero and axis are one
number there. So only the gyros make a session.
"""

from dataclasses import replace

import numpy as np

from benchmarks.recordings.sets import folder
from estimator.session import ARBITRARY_ORIENTATIONS, GYROSCOPE, Array, CalibrationSession, Sensor, Site

ADIS = "adis16405-static/adis16405_run1.npz"
COLD = "temperature-ramps/mpu6050-cold-start/cold-start-2026-10-06.excerpt.csv"
ADIS_RATE = 100.0
"""Hz."""
ADIS_LSB = np.radians(0.05)
"""rad/s."""
STRETCH = 100
"""s that become one row of the ADIS16405."""
SECOND = int(ADIS_RATE)
GROUP = 6
"""Samples that become one row of the MPU-6050."""
BREAK = 20.0
"""s; the excerpt's pieces lie farther apart."""


def gyro_session(unit: str, readings: Array, errors: Array, time: Array, warmth: Array | None) -> CalibrationSession:
    """Three rate gyros at rest, rows (R, 3) in rad/s."""
    names = ("Gx", "Gy", "Gz")
    return CalibrationSession(
        unit=unit,
        block=GYROSCOPE,
        programme=ARBITRARY_ORIENTATIONS,
        sensors=tuple(Sensor(n, GYROSCOPE, np.eye(3)[k], 1.0, "rad/s") for k, n in enumerate(names)),
        readings=readings,
        standard_errors=np.broadcast_to(errors, readings.shape),
        site=Site(),
        time=time,
        temperature=warmth,
    )


def adis16405() -> CalibrationSession:
    """100 rows of 100 s; the standard error is what neighbouring one-second means say of the white noise."""
    counts = np.load(folder() / ADIS)["counts"][:, :3].astype(float) * ADIS_LSB
    seconds = counts.reshape(-1, STRETCH, SECOND, 3).mean(axis=2)
    white = np.sqrt((np.diff(seconds, axis=1) ** 2).mean(axis=(0, 1)) / 2 / STRETCH)
    rows = seconds.mean(axis=1)
    return gyro_session("ADIS16405", rows, white, STRETCH * np.arange(len(rows), dtype=float), None)


def mpu6050() -> CalibrationSession:
    """Means of six samples (three seconds) of every piece of the excerpt, with their temperature."""
    lines = (folder() / COLD).read_text().splitlines()
    table = np.array([[float(x) for x in line.split(",")[1:9]] for line in lines if line[:1].isdigit()])
    seconds = table[:, 0] * 1e-6
    piece = np.cumsum(np.diff(seconds, prepend=seconds[0]) > BREAK)
    groups = [
        table[piece == p][k : k + GROUP]
        for p in np.unique(piece)
        for k in range(0, int((piece == p).sum()) - GROUP + 1, GROUP)
    ]
    means = np.array([g.mean(axis=0) for g in groups])
    steps = np.concatenate([np.diff(g[:, 5:8], axis=0) for g in groups])
    white = np.sqrt((steps**2).mean(axis=0) / 2 / GROUP)
    return replace(
        gyro_session("MPU-6050", means[:, 5:8], white, means[:, 0] * 1e-6, means[:, 1]),
        switched_on=0.0,  # its clock is the board's uptime
    )
