"""People's units, and numbers as people write them: rounded as their uncertainty deserves. SI ends here."""

from dataclasses import dataclass
from math import floor, isfinite, log10, pi

from estimator.session import GYROSCOPE

STANDARD_GRAVITY = 9.80665
"""m/s² in one g, as people count in g; not the local gravity."""
DEGREE = pi / 180
THIN = "\u202f"
HARD = "\u00a0"
"""A space that does not break the line."""
MINUS = "\u2212"
UNKNOWN = "\u2013"
COVERAGE = 2.0
"""k of the uncertainties that are shown where no decision states its own."""


@dataclass(frozen=True)
class DeviationUnit:
    """The number that people read is the SI number times ``factor``."""

    label: str
    factor: float


PPM = DeviationUnit("ppm", 1e6)
ARCSEC = DeviationUnit("arcsec", 3600 / DEGREE)

DEVIATION_UNITS = {
    ("accelerometer", "scale"): PPM,
    ("accelerometer", "bias"): DeviationUnit("µg", 1e6 / STANDARD_GRAVITY),
    ("accelerometer", "quadratic"): DeviationUnit("µg/g²", 1e6 * STANDARD_GRAVITY),
    ("accelerometer", "axis"): ARCSEC,
    ("gyroscope", "scale"): PPM,
    ("gyroscope", "bias"): DeviationUnit("°/h", 3600 / DEGREE),
    ("gyroscope", "quadratic"): DeviationUnit("ppm/(°/s)", 1e6 * DEGREE),
    ("gyroscope", "axis"): ARCSEC,
    ("gyroscope", "misalignment"): ARCSEC,
}
COARSE_UNITS = {
    ("accelerometer", "scale"): DeviationUnit("%", 1e2),
    ("accelerometer", "bias"): DeviationUnit("mg", 1e3 / STANDARD_GRAVITY),
    ("accelerometer", "quadratic"): DeviationUnit("mg/g²", 1e3 * STANDARD_GRAVITY),
    ("accelerometer", "axis"): DeviationUnit("°", 1 / DEGREE),
    ("gyroscope", "scale"): DeviationUnit("%", 1e2),
    ("gyroscope", "bias"): DeviationUnit("°/s", 1 / DEGREE),
    ("gyroscope", "quadratic"): DeviationUnit("%/(°/s)", 1e2 * DEGREE),
    ("gyroscope", "axis"): DeviationUnit("°", 1 / DEGREE),
    ("gyroscope", "misalignment"): DeviationUnit("°", 1 / DEGREE),
}
"""What to change to when the numbers of the fine unit would pass 9,999."""
PER_G = DeviationUnit("per g", STANDARD_GRAVITY)
PER_RATE = DeviationUnit("per °/s", DEGREE)


def in_unit(si: float | None, unit: DeviationUnit) -> float | None:
    """The SI number as people read it; None stays None."""
    return None if si is None else si * unit.factor


def deviation_unit(kind: str, parameter: str, largest: float) -> DeviationUnit:
    """The unit for deviations up to ``largest`` (SI; relative for scale)."""
    fine, coarse = DEVIATION_UNITS[kind, parameter], COARSE_UNITS[kind, parameter]
    return fine if not isfinite(largest) or abs(largest) * fine.factor < 1e4 else coarse


def value_unit(kind: str, parameter: str, largest: float) -> DeviationUnit:
    """The unit for values up to ``largest``; scale factors are read per g or per degree a second."""
    if parameter == "scale":
        return reading_unit(kind)
    return deviation_unit(kind, parameter, largest)


def reading_unit(kind: str) -> DeviationUnit:
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


def signed(value: float | None, expanded: float | None, unit: DeviationUnit) -> str:
    """The same for a change: with a plus where it is not negative."""
    text = measured(value, expanded, unit)
    return text if value is None or text.startswith(MINUS) else f"+{text}"


def limit(tolerance: float, unit: DeviationUnit, one_sided: bool) -> str:
    """``±40 µg``, or ``30 ″`` for what cannot be negative."""
    return f"{'' if one_sided else '±'}{number(in_unit(tolerance, unit))}{THIN}{unit.label}"


def measured(value: float | None, expanded: float | None, unit: DeviationUnit) -> str:
    """``12.3 ± 1.4 µg`` of SI numbers, rounded as the uncertainty deserves."""
    shown, spread = in_unit(value, unit), in_unit(expanded, unit)
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
    unit = DEVIATION_UNITS[kind, parameter]
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
ANGLE_RATES = frozenset({"axis-creep", "stand-drift"})
"""Causes whose rad/s is an angle that grows, not a rate that is measured."""
AMPLITUDE_UNITS = {
    "1": PPM,
    "1/K": DeviationUnit("ppm/K", 1e6),
    "1/s": DeviationUnit("ppm/h", 1e6 * PER_HOUR),
    "m/s²": DeviationUnit("µg", MICRO_G),
    "m/s²/K": DeviationUnit("µg/K", MICRO_G),
    "m/s²/s": DeviationUnit("µg/h", MICRO_G * PER_HOUR),
    "m/s²/(K/s)": DeviationUnit("µg/(K/h)", MICRO_G / PER_HOUR),
    "(m/s²)⁻¹": DeviationUnit("µg/g²", 1e6 * STANDARD_GRAVITY),
    "(m/s²)⁻²": DeviationUnit("µg/g³", 1e6 * STANDARD_GRAVITY**2),
    "rad": ARCSEC,
    "rad/s": DeviationUnit("°/h", PER_HOUR / DEGREE),
    "rad/s/K": DeviationUnit("(°/h)/K", PER_HOUR / DEGREE),
    "rad/s/s": DeviationUnit("(°/h)/h", PER_HOUR**2 / DEGREE),
    "rad/s/(K/s)": DeviationUnit("(°/h)/(K/h)", 1 / DEGREE),
    "(rad/s)⁻¹": DeviationUnit("ppm at Earth rate", 1e6 * EARTH_RATE),
    "(rad/s)⁻²": DeviationUnit("ppm at Earth rate", 1e6 * EARTH_RATE**2),
    "(rad/s)/(m/s²)": DeviationUnit("(°/h)/g", PER_HOUR / DEGREE * STANDARD_GRAVITY),
}
"""People's unit of a cause's amplitude, by its SI unit."""
COARSER = {
    "ppm": DeviationUnit("%", 1e2),
    "µg": DeviationUnit("mg", 1e3 / STANDARD_GRAVITY),
    "arcsec": DeviationUnit("°", 1 / DEGREE),
}


def amplitude_unit(cause: str, si_unit: str, largest: float) -> DeviationUnit:
    """The unit for amplitudes of a cause up to ``largest`` (SI)."""
    if si_unit == "rad/s" and cause in ANGLE_RATES:
        return DeviationUnit("arcsec/h", ARCSEC.factor * PER_HOUR)
    unit = AMPLITUDE_UNITS.get(si_unit, DeviationUnit(si_unit, 1.0))
    return unit if abs(largest) * unit.factor < 1e4 else COARSER.get(unit.label, unit)
