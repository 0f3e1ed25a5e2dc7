"""Answers of `estimator.readiness` to public recordings: `python -m benchmarks.readiness_recordings`.

Units of a factory's grade, so with tolerances of theirs: 10 mg and 1 % for accelerometers, 0.2 °/s for gyros, and a
programme of ten minutes.
"""

from dataclasses import replace

import numpy as np

from benchmarks.diagnosed_recordings.still import ADIS, ADIS_LSB, ADIS_RATE, COLD
from benchmarks.readiness import G
from benchmarks.recordings.sets import folder, logs
from estimator.readiness import Allowed, Question, readiness
from estimator.session import ACCELEROMETER, ARBITRARY_ORIENTATIONS, GYROSCOPE, Array, CalibrationSession, Sensor
from service.planning.words import readiness_headline, reasons

RAMP = "temperature-ramps/icm42652-cold-ramp/Sample_data.csv"
RAMP_RATE = 500.0
"""Hz."""
MILLI_G = 1e-3 * G
QUESTION = Question(
    {ACCELEROMETER: Allowed(10 * MILLI_G, 0.01), GYROSCOPE: Allowed(float(np.radians(0.2)))}, duration=600.0
)


def triads(unit: str, readings: Array, **clock: object) -> CalibrationSession:
    """Three accelerometers, m/s², and where there are six columns three gyros, rad/s."""
    kinds = (ACCELEROMETER, GYROSCOPE)[: readings.shape[1] // 3]
    sensors = tuple(
        Sensor(f"{k[0].upper()}{a}", k, e, 1.0, "SI") for k in kinds for a, e in zip("xyz", np.eye(3), strict=True)
    )
    empty = np.full(readings.shape, np.nan)
    return replace(CalibrationSession(unit, ACCELEROMETER, ARBITRARY_ORIENTATIONS, sensors, readings, empty), **clock)


def records() -> list[tuple[str, CalibrationSession]]:
    """The beginnings of recordings at rest, and pieces of them."""
    counts = np.load(folder() / ADIS)["counts"]
    adis = np.hstack([counts[:, 3:] * 3.33 * MILLI_G, counts[:, :3] * ADIS_LSB])
    ramp = np.loadtxt(folder() / RAMP, delimiter=",")
    lines = (folder() / COLD).read_text().splitlines()
    cold = np.array([[float(x) for x in line.split(",")[1:9]] for line in lines if line[:1].isdigit()])
    pieces = np.split(cold, np.flatnonzero(np.diff(cold[:, 0]) > 20e6) + 1)
    held = logs("imu-tk")[0].session
    found = [
        (
            f"ADIS16405, minute {minute} on",
            triads("ADIS16405", adis[6000 * minute : 6000 * (minute + 5)], sample_rate=ADIS_RATE),
        )
        for minute in (0, 60, 160)
    ]
    for name, rows in (("before it warms, 140 s", ramp[:70_000]), ("whole, 200 s", ramp)):
        own = triads("ICM-42652", rows[:, 1:4] * MILLI_G, sample_rate=RAMP_RATE, temperature=rows[:, 4])
        found.append((f"ICM-42652 {name}", own))
    for piece in (*pieces, cold):
        at = (piece[:, 0] - piece[0, 0]) * 1e-6
        name = f"MPU-6050 cold start, {piece[0, 0] * 1e-6:.0f} to {piece[-1, 0] * 1e-6:.0f} s"
        found.append((name, triads("MPU-6050", piece[:, 2:8], time=at, temperature=piece[:, 1])))
    for name, count in (("first 45 s, at rest", 4500), ("first 90 s, then moved", 9000)):
        time = None if held.time is None else held.time[:count] - held.time[0]
        found.append((f"Xsens MTi, {name}", replace(held, readings=held.readings[:count], time=time, position=None)))
    return found


def main() -> None:
    """Prints the table."""
    print("| recording | answer | first reason |")
    print("| --- | --- | --- |")
    for name, session in records():
        answer = readiness(session, QUESTION, np.random.default_rng(1))
        why = reasons(answer, session.sensors[0].kind)
        print(f"| {name} | {readiness_headline(answer)} | {why[0] if why else ''} |")


if __name__ == "__main__":
    main()
