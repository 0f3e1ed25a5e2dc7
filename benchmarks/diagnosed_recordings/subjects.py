"""The recordings and their diagnoses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchmarks.diagnosed_recordings.groups import accelerometers, some
from benchmarks.diagnosed_recordings.still import adis16405, mpu6050
from benchmarks.recordings.sets import recordings
from estimator import Diagnosis, diagnose
from estimator.session import CalibrationSession


@dataclass(frozen=True, eq=False)
class Subject:
    """One session to be diagnosed."""

    title: str
    session: CalibrationSession
    history: Sequence[CalibrationSession] = ()


@dataclass(frozen=True, eq=False)
class Diagnosed:
    """One session and what is wrong with its simulation."""

    subject: Subject
    diagnosis: Diagnosis


def sessions(format_name: str) -> list[Subject]:
    """Every session of a converted recording by itself."""
    return [Subject(r.name, r.session) for r in recordings(format_name)]


TRIADS = 8
"""Number of triads on the sensor array's board."""


def array_sessions() -> list[Subject]:
    """The sensor array's three sessions by themselves, and the accelerometers of the second against the first."""
    alone = sessions("kth-mimu")
    first, second = (some(s.session, accelerometers(s.session, TRIADS)) for s in alone[:2])
    return [*alone, Subject("kth-mimu-exp_4 since exp_1, accelerometers", second, (first,))]


PAGES: dict[str, Callable[[], list[Subject]]] = {
    "imu-tk": lambda: sessions("imu-tk"),
    "mpu9150-five": lambda: sessions("mpu9150-five"),
    "kth-mimu-array": array_sessions,
    "ctu": lambda: sessions("ctu-mat"),
    "ferraris": lambda: sessions("ferraris-csv"),
    "adis16405-static": lambda: [Subject("adis16405, gyros, 100 s a row", adis16405())],
    "temperature-ramps": lambda: [Subject("mpu6050 cold start, gyros", mpu6050())],
}
"""A page each, in the order of the index."""


def diagnosed(name: str) -> list[Diagnosed]:
    """The sessions of a page and their diagnoses."""
    return [Diagnosed(s, diagnose(s.session, s.history)) for s in PAGES[name]()]
