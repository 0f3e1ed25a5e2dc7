"""What the sizes of causes are read in: one measure for every SI unit in which the catalogue states an amplitude."""

from estimator.applied_vector import EARTH_RATE, STANDARD_GRAVITY
from estimator.causes import find
from estimator.message import say
from service.kit.measures import ARCSEC, DEGREE, PPM, READABLE, Measure

PER_HOUR = 3600.0
"""s."""
MICRO_G = 1e6 / STANDARD_GRAVITY
"""Micro-g in one m/s²."""
AMPLITUDE_MEASURES = {
    "1": PPM,
    "1/K": Measure("ppm/K", 1e6),
    "1/s": Measure("ppm/h", 1e6 * PER_HOUR),
    "m/s²": Measure("µg", MICRO_G),
    "m/s²/K": Measure("µg/K", MICRO_G),
    "m/s²/s": Measure("µg/h", MICRO_G * PER_HOUR),
    "m/s²/(K/s)": Measure("µg/(K/h)", MICRO_G / PER_HOUR),
    "(m/s²)⁻¹": Measure("µg/g²", 1e6 * STANDARD_GRAVITY),
    "(m/s²)⁻²": Measure("µg/g³", 1e6 * STANDARD_GRAVITY**2),
    "m": Measure("cm", 100.0),
    "rad": ARCSEC,
    "rad/s": Measure("°/h", PER_HOUR / DEGREE),
    "rad/s/K": Measure("(°/h)/K", PER_HOUR / DEGREE),
    "rad/s/s": Measure("(°/h)/h", PER_HOUR**2 / DEGREE),
    "rad/s/(K/s)": Measure("(°/h)/(K/h)", 1 / DEGREE),
    "(rad/s)⁻¹": Measure(say("ppm at Earth rate"), 1e6 * EARTH_RATE),
    "(rad/s)⁻²": Measure(say("ppm at Earth rate"), 1e6 * EARTH_RATE**2),
    "(rad/s)/(m/s²)": Measure("(°/h)/g", PER_HOUR / DEGREE * STANDARD_GRAVITY),
}
"""What the amplitude of a cause is read in, by its SI unit. A gyro on a stand feels the Earth's rate alone, so its
nonlinearity is read as what it makes there."""
COARSER = {
    "ppm": Measure("%", 1e2),
    "µg": Measure("mg", 1e3 / STANDARD_GRAVITY),
    "arcsec": Measure("°", 1 / DEGREE),
}
"""What amplitudes change to, by the label of the fine measure."""


def amplitude_measure(cause: str, si_unit: str, largest: float) -> Measure:
    """The measure for amplitudes of a cause up to ``largest`` (SI)."""
    known = find(cause)
    if si_unit == "rad/s" and known is not None and known.grows_an_angle:
        return Measure("arcsec/h", ARCSEC.factor * PER_HOUR)
    measure = AMPLITUDE_MEASURES.get(si_unit, Measure(si_unit, 1.0))
    return measure if abs(largest) * measure.factor < READABLE else COARSER.get(measure.label, measure)
