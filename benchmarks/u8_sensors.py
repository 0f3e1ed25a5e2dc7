"""U8: one session of 48 accelerometers in 20 orientations, diagnosed: as it is, and with a bias ramp of 12 standard
errors on one of them. Seconds of the processor."""

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.figures import Felt, children, importing
from benchmarks.orientations import GRAVITY, NOISE, case, sphere
from estimator import CalibrationSession, diagnose

SENSORS, ORIENTATIONS, STRENGTH = 48, 20, 12.0


def sessions() -> tuple[CalibrationSession, CalibrationSession]:
    """Sound, and with a ramp over the session whose root mean square is STRENGTH / √rows sigmas of a reading."""
    rng = np.random.default_rng(8)
    sound = case(SENSORS, sphere(ORIENTATIONS, rng), rng).measured(rng)
    ramp = np.linspace(-1.0, 1.0, len(sound.readings))
    size = STRENGTH * 0.12 * GRAVITY * NOISE / np.linalg.norm(ramp)
    readings = sound.readings.copy()
    readings[:, 6] += size * ramp
    return sound, replace(sound, readings=readings)


def seconds(session: CalibrationSession) -> float:
    """Processor seconds of one diagnosis."""
    began = time.process_time()
    diagnose(session)
    return time.process_time() - began


def run() -> Iterator[Felt]:
    """Both."""
    for name, session in zip(("sound", "a bias ramp"), sessions(), strict=True):
        work = f"diagnose {SENSORS} sensors × {ORIENTATIONS} orientations, {name}"
        yield Felt(f"U8, {name}", f"{work}, processor", seconds(session), 60, m=importing(children))
