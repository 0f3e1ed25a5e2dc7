"""The recordings, from the raw files to averaged sessions."""

import os
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from benchmarks.convert import convert
from estimator.calibration.free import residual_per_freedom, tilt_response
from estimator.reading import read_session
from estimator.session import ACCELEROMETER, CalibrationSession, Sensor
from estimator.static import average

FOLDER = "IMU_HEALTH_RECORDINGS"
FILES = {
    "imu-tk": "imu-tk-xsens-mti/*.mat",
    "mpu9150-five": "mpu9150-five/*.log",
    "kth-mimu": "kth-mimu-array/*.bin",
    "ctu-mat": "ctu-orientations/measured_accelerations_*.mat",
    "ferraris-csv": "ferraris-six-position/*.csv",
}


def folder() -> Path:
    """Folder of the recordings: as the environment states it, or beside the project."""
    return Path(os.environ.get(FOLDER, Path(__file__).resolve().parents[3] / "shared" / "data"))


@dataclass(frozen=True, eq=False)
class Recording:
    """One averaged session of a recording."""

    name: str
    session: CalibrationSession

    @property
    def g(self) -> float:
        """m/s², as the publication states it."""
        assert self.session.site.gravity is not None
        return self.session.site.gravity

    @property
    def triads(self) -> list[tuple[Sensor, ...]]:
        """The accelerometers, three neighbours at a time."""
        found = [s for s in self.session.sensors if s.kind == ACCELEROMETER]
        return [tuple(found[k : k + 3]) for k in range(0, len(found), 3)]


@cache
def logs(format_name: str, most: int | None = None) -> tuple[Recording, ...]:
    """The sessions of all files of a format as recorded, oldest first; raw logs where the files hold those. ``most``:
    of the first files only."""
    converted = convert(format_name, sorted(folder().glob(FILES[format_name]))[:most])
    return tuple(Recording(name.removesuffix(".json"), read_session(document)) for name, document in converted)


@cache
def recordings(format_name: str, most: int | None = None) -> tuple[Recording, ...]:
    """The averaged sessions of all files of a format, oldest first."""
    return tuple(
        replace(log, session=average(log.session, residual_per_freedom, tilt_response)) if log.session.is_raw else log
        for log in logs(format_name, most)
    )
