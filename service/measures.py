"""Measures that people use (µg, ppm, arcsec), and numbers rounded as their uncertainty deserves. SI ends here."""

from dataclasses import dataclass
from math import floor, isfinite, log10, pi

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.causes import find
from estimator.session import GYROSCOPE

DEGREE = pi / 180
THIN = "\u202f"
HARD = "\u00a0"
"""A space that does not break the line."""
MINUS = "\u2212"
UNKNOWN = "\u2013"
COVERAGE = 2.0
"""k of the uncertainties that are shown where no decision states its own."""


@dataclass(frozen=True)
class Measure:
    """The number that people read is the SI number times ``factor``."""

    label: str
    factor: float


PPM = Measure("ppm", 1e6)
ARCSEC = Measure("arcsec", 3600 / DEGREE)

MEASURES = {
    ("accelerometer", "scale"): PPM,
    ("accelerometer", "bias"): Measure("µg", 1e6 / STANDARD_GRAVITY),
    ("accelerometer", "quadratic"): Measure("µg/g²", 1e6 * STANDARD_GRAVITY),
    ("accelerometer", "axis"): ARCSEC,
    ("gyroscope", "scale"): PPM,
    ("gyroscope", "bias"): Measure("°/h", 3600 / DEGREE),
    ("gyroscope", "quadratic"): Measure("ppm/(°/s)", 1e6 * DEGREE),
    ("gyroscope", "axis"): ARCSEC,
    ("gyroscope", "misalignment"): ARCSEC,
}
COARSE_MEASURES = {
    ("accelerometer", "scale"): Measure("%", 1e2),
    ("accelerometer", "bias"): Measure("mg", 1e3 / STANDARD_GRAVITY),
    ("accelerometer", "quadratic"): Measure("mg/g²", 1e3 * STANDARD_GRAVITY),
    ("accelerometer", "axis"): Measure("°", 1 / DEGREE),
    ("gyroscope", "scale"): Measure("%", 1e2),
    ("gyroscope", "bias"): Measure("°/s", 1 / DEGREE),
    ("gyroscope", "quadratic"): Measure("%/(°/s)", 1e2 * DEGREE),
    ("gyroscope", "axis"): Measure("°", 1 / DEGREE),
    ("gyroscope", "misalignment"): Measure("°", 1 / DEGREE),
}
"""What to change to when the numbers of the fine unit would pass 9,999."""
PER_G = Measure("per g", STANDARD_GRAVITY)
PER_RATE = Measure("per °/s", DEGREE)


def in_measure(si: float | None, unit: Measure) -> float | None:
    """The SI number as people read it; None stays None."""
    return None if si is None else si * unit.factor


def deviation_measure(kind: str, parameter: str, largest: float) -> Measure:
    """The unit for deviations up to ``largest`` (SI; relative for scale)."""
    fine, coarse = MEASURES[kind, parameter], COARSE_MEASURES[kind, parameter]
    return fine if not isfinite(largest) or abs(largest) * fine.factor < 1e4 else coarse


def value_measure(kind: str, parameter: str, largest: float) -> Measure:
    """The unit for values up to ``largest``; scale factors are read per g or per degree a second."""
    if parameter == "scale":
        return scale_measure(kind)
    return deviation_measure(kind, parameter, largest)


def scale_measure(kind: str) -> Measure:
    """What scale factors are counted per."""
    return PER_RATE if kind == GYROSCOPE else PER_G


def decimals(uncertainty: float | None) -> int | None:
    """Digits after the point for two significant digits of an uncertainty; None when it says nothing."""
    if uncertainty is None or not isfinite(uncertainty) or uncertainty <= 0:
        return None
    return min(12, max(0, 1 - floor(log10(uncertainty))))


def number(value: float | None, digits: int | None = None) -> str:
    """A number for reading, grouped, with a true minus; four significant digits unless decimals are given."""
    if value is None or not isfinite(value):
        return UNKNOWN
    if digits is None:
        places = 0 if value == 0 else min(12, max(0, 3 - floor(log10(abs(value)))))
        text = f"{abs(value):,.{places}f}"
        text = text.rstrip("0").rstrip(".") if "." in text else text
    else:
        text = f"{abs(value):,.{digits}f}"
    text = text.replace(",", THIN)
    negative = value < 0 and any(c in "123456789" for c in text)
    return MINUS + text if negative else text


def signed(value: float | None, expanded: float | None, unit: Measure) -> str:
    """The same for a change: with a plus where it is not negative."""
    text = measured(value, expanded, unit)
    return text if value is None or text.startswith(MINUS) else f"+{text}"


def limit(tolerance: float, unit: Measure, one_sided: bool) -> str:
    """``±40 µg``, or ``30 ″`` for what cannot be negative."""
    return f"{'' if one_sided else '±'}{number(in_measure(tolerance, unit))}{THIN}{unit.label}"


def measured(value: float | None, expanded: float | None, unit: Measure) -> str:
    """``12.3 ± 1.4 µg`` of SI numbers, rounded as the uncertainty deserves."""
    shown, spread = in_measure(value, unit), in_measure(expanded, unit)
    digits = decimals(spread)
    if digits is None:
        return f"{number(shown)}{THIN}{unit.label}"
    return f"{number(shown, digits)}{HARD}±{HARD}{number(spread, digits)}{THIN}{unit.label}"


def size_in_words(count: int) -> str:
    """``12.3 kB``."""
    for size, label in ((1e6, "MB"), (1e3, "kB")):
        if count >= size:
            return f"{count / size:.1f}{THIN}{label}"
    return f"{count} bytes"


def in_words(kind: str, parameter: str, si: float, *, signed: bool = False) -> str:
    """``+62 µg``: a deviation with two or three significant digits and its unit."""
    unit = MEASURES[kind, parameter]
    shown = si * unit.factor
    if not isfinite(shown):
        return f"unknown {unit.label}"
    digits = 0 if shown == 0 else max(0, 1 - floor(log10(abs(shown))))
    sign = "+" if signed and shown > 0 else ""
    return f"{sign}{shown:,.{digits}f} {unit.label}".replace("-", "−")


PER_HOUR = 3600.0
MICRO_G = 1e6 / STANDARD_GRAVITY
EARTH_RATE = 7.292115e-5
"""rad/s."""
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
    "rad": ARCSEC,
    "rad/s": Measure("°/h", PER_HOUR / DEGREE),
    "rad/s/K": Measure("(°/h)/K", PER_HOUR / DEGREE),
    "rad/s/s": Measure("(°/h)/h", PER_HOUR**2 / DEGREE),
    "rad/s/(K/s)": Measure("(°/h)/(K/h)", 1 / DEGREE),
    "(rad/s)⁻¹": Measure("ppm at Earth rate", 1e6 * EARTH_RATE),
    "(rad/s)⁻²": Measure("ppm at Earth rate", 1e6 * EARTH_RATE**2),
    "(rad/s)/(m/s²)": Measure("(°/h)/g", PER_HOUR / DEGREE * STANDARD_GRAVITY),
}
"""People's unit of a cause's amplitude, by its SI unit."""
COARSER = {
    "ppm": Measure("%", 1e2),
    "µg": Measure("mg", 1e3 / STANDARD_GRAVITY),
    "arcsec": Measure("°", 1 / DEGREE),
}


def amplitude_measure(cause: str, si_unit: str, largest: float) -> Measure:
    """The unit for amplitudes of a cause up to ``largest`` (SI)."""
    known = find(cause)
    if si_unit == "rad/s" and known is not None and known.grows_an_angle:
        return Measure("arcsec/h", ARCSEC.factor * PER_HOUR)
    unit = AMPLITUDE_MEASURES.get(si_unit, Measure(si_unit, 1.0))
    return unit if abs(largest) * unit.factor < 1e4 else COARSER.get(unit.label, unit)
