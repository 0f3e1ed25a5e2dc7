"""Sessions without a stand: alignments and rate tables on a turntable, recordings in service of a redundant block."""

from dataclasses import replace

import numpy as np

from estimator.alignment.simulate import (
    Imperfections,
    Truth,
    TurntableProgramme,
    simulate_alignment,
    simulate_rate_table,
    triads,
)
from estimator.parameters import SensorParameters
from estimator.parity.flight import AEROBATIC, Weather, fly
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, GYROSCOPE, Array, CalibrationSession, Sensor
from estimator.simulate import orientation_schedule
from service.demo.blocks import MICRO_G, SITE, sensors_of

STOPS = TurntableProgramme(dwell=200.0, row=1.0)
"""Seconds: 200 at rest a stop, one a row."""
START = 2.0
"""s in which the table comes up to its rate: whole rows."""
TURNTABLE = Imperfections(wobble=0.3 * ARCSEC, table=0.3 * ARCSEC)
"""A good one: 0.3″."""
TURNS = ((0.5, 80.0), (-0.5, 80.0))
"""Six whole turns each way: rad/s and s."""
MOUNTING = (4 * ARCSEC, 8 * ARCSEC)
"""E_xz, E_yz of the published simulation."""
DEGREE_PER_HOUR = np.pi / 180 / 3600
"""rad/s."""
FLIGHT_SECONDS, FLIGHT_RATE = 240.0, 10.0
"""Four minutes; readings a second."""
FLIGHT = Weather(noise=5 * MICRO_G, vibration=0.2)
"""Noise of a reading, m/s², and vibration."""

RATE_NOISE = 3e-4
"""rad/s: a micromechanical gyro over some seconds, 0.017 °/s; the Earth's rate is a quarter of it."""


def turntable_truth(zeros: Array, drifts: Array, rng: np.random.Generator) -> Truth:
    """Zeros of the accelerometers' axes (3,), µg, and of the gyros', °/h; set down in any heading, not quite level."""
    return Truth(
        accelerometer_bias=zeros * MICRO_G,
        gyro_bias=drifts * DEGREE_PER_HOUR,
        mounting=MOUNTING,
        heading=float(rng.uniform(0, 2 * np.pi)),
        tilt=(float(2e-4 * rng.standard_normal()), float(2e-4 * rng.standard_normal())),
    )


def alignment(unit: str, truth: Truth, rng: np.random.Generator) -> CalibrationSession:
    """Two positions 180° apart of three accelerometers and three gyros; off the turn axis they need a gentle start."""
    stops = STOPS if truth.positions is None else replace(STOPS, ramp=START)
    session, _ = simulate_alignment(triads(), SITE, stops, truth, rng, imperfections=TURNTABLE, unit=unit)
    return session


def rate_table(unit: str, truth: Truth, rng: np.random.Generator) -> CalibrationSession:
    """Six whole turns each way of three gyros."""
    return simulate_rate_table(triads(), SITE, TURNS, truth, rng, row=0.5, unit=unit)


def recording(
    unit: str, sensors: tuple[Sensor, ...], truth: SensorParameters, rng: np.random.Generator
) -> CalibrationSession:
    """Four minutes of flight, sampled ten times a second."""
    flown = fly(
        sensors,
        truth,
        rng,
        manoeuvres=AEROBATIC,
        seconds=FLIGHT_SECONDS,
        rate=FLIGHT_RATE,
        weather=FLIGHT,
        site=SITE,
        unit_name=unit,
    )
    return replace(flown, readings=np.round(flown.readings, 7))


def orientations(unit: str, count: int, positions: int, rng: np.random.Generator) -> CalibrationSession:
    """A block of accelerometers and as many rate gyros along the same axes, still to be held in so many positions."""
    accelerometers = sensors_of(ACCELEROMETER, count)
    gyros = [
        replace(s, name=f"G{i}", kind=GYROSCOPE, nominal_scale=1.0, reading_unit="rad/s", bias_repeatability=0.0)
        for i, s in enumerate(accelerometers, 1)
    ]
    return orientation_schedule((*accelerometers, *gyros), SITE, rng.standard_normal((positions, 3)), unit_name=unit)
